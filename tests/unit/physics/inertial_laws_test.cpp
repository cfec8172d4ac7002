#include <cmath>

#include <gtest/gtest.h>

#include "grainvdb/laws.hpp"
#include "unit/physics/printed.hpp"

namespace grainvdb::inertial_laws_test {
namespace {

TEST(FrictionLaw, PrintedValues) {
  const FrictionLaw mu{.12, .55, .2};
  EXPECT_NEAR(mu(.01), .1405, half_a_digit(4));
  EXPECT_NEAR(mu(.1), .2633, half_a_digit(4));
  EXPECT_NEAR(mu(.2), .335, half_a_digit(4));
  EXPECT_NEAR(mu(1), .4783, half_a_digit(4));
}

TEST(FrictionLaw, LimitsOfTheInertialNumber) {
  const FrictionLaw mu;
  EXPECT_EQ(mu(0), .12);
  EXPECT_NEAR(mu(1e12), .55, 1e-11);  // falls short by (μ_∞-μ₀) I₀/I
}

TEST(SoftFrictionLaw, FallsWithTheRootOfThePressure) {
  const SoftFrictionLaw mu;
  EXPECT_EQ(mu(.1, 0), FrictionLaw{}(.1));
  EXPECT_DOUBLE_EQ(mu(.1, .225), FrictionLaw{}(.1) / 2);  // √(.225/.9) = ½
  EXPECT_NEAR(mu(.1, .9), 0, 1e-16);
}

// The closed form must solve the implicit law it came from.
TEST(PackingLaw, SolvesTheImplicitEquation) {
  const PackingLaw law;
  for (double i : {0.0, 1e-3, .1, 1.0, 10.0, 1e6}) {
    for (double p : {0.0, .01, .33, 2.0}) {
      const double nu = law(i, p);
      const double terms = nu + .636 * (1 + p / .33) * (1 + i * std::sqrt(nu) / 3.28);
      EXPECT_NEAR(nu, .636 * (1 + p / .33) * (1 - i * std::sqrt(nu) / 3.28), 1e-15 * terms) << i << ' ' << p;
    }
  }
}

TEST(PackingLaw, LimitsOfTheInertialNumber) {
  const PackingLaw law;
  EXPECT_DOUBLE_EQ(law(0, 0), .636);
  EXPECT_DOUBLE_EQ(law(0, .33), 2 * .636);
  // √ν → I_c/I as I → ∞, whatever the pressure, with relative corrections of order (I_c/I)²/ν_c.
  EXPECT_NEAR(law(3.28e6, 0) * 1e12, 1, 1e-11);
}

}  // namespace
}  // namespace grainvdb::inertial_laws_test
