#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "grainvdb/laws.hpp"
#include "unit/physics/printed.hpp"

namespace grainvdb::fluidity_law_test {
namespace {

TEST(FluidityLaw, ZhangKamrinHasThePublishedValues) {
  const double phi[] = {.50, .55, .58, .60, .62};
  const double f[] = {1.9801, 1.9486, 1.7415, 1.0930, .2942};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(zhang_kamrin_law(phi[i]), f[i], half_a_digit(4)) << "phi = " << phi[i];
}

TEST(FluidityLaw, ZeroIsWhereTheLawVanishes) {
  EXPECT_NEAR(zhang_kamrin_law.zero(), .627198, half_a_digit(6));
  // F has slope below 2/D there; one rounding of phi moves it by less than 1e-14.
  EXPECT_NEAR(zhang_kamrin_law(zhang_kamrin_law.zero()), 0, 1e-13);
  EXPECT_LT(zhang_kamrin_law(.63), 0);
  for (const FluidityFit& fit : fluidity_fits) EXPECT_NEAR(fit.law(fit.law.zero()), 0, 1e-12) << fit.name;
}

TEST(FluidityLaw, PlateauAndSlope) {
  const FluidityLaw law{2.3, 0.6, 1e-4, 0.03};
  // x + sqrt(x²+C) = C/(2|x|) + … far below B, 2x + C/(2x) + … far above.
  EXPECT_NEAR(law(0.0), 2.3 - 1e-4 / 1.2 / 0.03, 1e-6);
  EXPECT_NEAR((law(5.6) - law(4.6)) / 1.0, -2 / 0.03, 1e-3);
  EXPECT_DOUBLE_EQ(law(0.6), 2.3 - 0.01 / 0.03);
}

TEST(FluidityLaw, TableFourAsPrinted) {
  ASSERT_EQ(fluidity_fits.size(), 9U);
  const double printed[9][4] = {
      {2.58, .625, 1.36e-4, .00719}, {2.43, .608, 1.32e-4, .0196}, {2.39, .599, 2.03e-4, .0293},
      {2.00, .584, .845e-4, .0377},  {1.94, .568, .319e-4, .0565}, {1.96, .578, 3.30e-4, .0449},
      {1.83, .570, 1.53e-4, .0537},  {1.75, .554, .319e-4, .0732}, {1.90, .605, 7.27e-4, .0215}};
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < 9; ++i) {
    const FluidityLaw& law = fluidity_fits[i].law;
    EXPECT_EQ(law.a, printed[i][0]);
    EXPECT_EQ(law.b, printed[i][1]);
    EXPECT_DOUBLE_EQ(law.c, printed[i][2]);
    EXPECT_EQ(law.d, printed[i][3]);
    names.insert(fluidity_fits[i].name);
  }
  EXPECT_EQ(names.size(), 9U);
}

}  // namespace
}  // namespace grainvdb::fluidity_law_test
