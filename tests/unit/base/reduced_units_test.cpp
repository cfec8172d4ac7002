#include "grainvdb/reduced_units.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainvdb::reduced_units_test {
namespace {

constexpr ReducedUnits beads{0.8e-3, 9.81, 2500};

TEST(ReducedUnits, SymbolsAreMadeOfGrainsAndGravity) {
  EXPECT_EQ(ReducedUnits::symbol(dimension::none), "1");
  EXPECT_EQ(ReducedUnits::symbol(dimension::length), "d");
  EXPECT_EQ(ReducedUnits::symbol(dimension::time), "sqrt(d/g)");
  EXPECT_EQ(ReducedUnits::symbol(dimension::mass), "rho_p d^3");
  EXPECT_EQ(ReducedUnits::symbol(dimension::velocity), "sqrt(g d)");
  EXPECT_EQ(ReducedUnits::symbol(dimension::acceleration), "g");
  EXPECT_EQ(ReducedUnits::symbol(dimension::rate), "sqrt(g/d)");
  EXPECT_EQ(ReducedUnits::symbol(dimension::density), "rho_p");
  EXPECT_EQ(ReducedUnits::symbol(dimension::stress), "rho_p g d");
  EXPECT_EQ(ReducedUnits::symbol(dimension::velocity_squared), "g d");
  EXPECT_EQ(ReducedUnits::symbol(dimension::rate_squared), "g/d");
  EXPECT_EQ(ReducedUnits::symbol(dimension::force_density), "rho_p g");
}

TEST(ReducedUnits, SymbolsOfUnusualQuantities) {
  EXPECT_EQ(ReducedUnits::symbol({0, -3, 0}), "1/d^3");
  EXPECT_EQ(ReducedUnits::symbol({0, -1, 1}), "1/sqrt(g d)");
  EXPECT_EQ(ReducedUnits::symbol({0, 2, -1}), "d sqrt(g d)");
  EXPECT_EQ(ReducedUnits::symbol({1, -1, -1}), "rho_p d sqrt(g d)");
  EXPECT_EQ(ReducedUnits::symbol({0, -1, -1}), "sqrt(g/d)/d");
  EXPECT_EQ(ReducedUnits::symbol({0, 0, 3}), "d sqrt(d/g)/g");
  EXPECT_EQ(ReducedUnits::symbol({-1, -2, 1}), "1/(rho_p d^4 sqrt(g d))");
}

// Powers of d, g and rho_p by hand, for every quantity with powers up to 3. A power, root or product is within two
// roundings, and there are less than ten of these.
TEST(ReducedUnits, SizesAreThoseOfTheSymbols) {
  constexpr double rounding = 20 * std::numeric_limits<double>::epsilon();
  for (int m = -3; m <= 3; ++m)
    for (int l = -3; l <= 3; ++l)
      for (int t = -3; t <= 3; ++t) {
        const double expected = std::pow(beads.density, m) * std::pow(beads.diameter, 3 * m + l + 0.5 * t) *
                                std::pow(beads.gravity, -0.5 * t);
        EXPECT_NEAR(beads.size({m, l, t}), expected, rounding * expected) << m << ' ' << l << ' ' << t;
        EXPECT_EQ((ReducedUnits{1, 1, 1}.size({m, l, t})), 1);
      }
}

}  // namespace
}  // namespace grainvdb::reduced_units_test
