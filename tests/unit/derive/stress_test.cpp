#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::stress_test {
namespace {

/// Pressure p and shear stress tau in the xz plane, tension positive.
std::vector<double> simple_shear(double p, double tau) {
  return {-p, 0, tau, 0, -p, 0, tau, 0, -p};
}

/// A voxel of material at rest, under a stress.
FakeInput under(const std::vector<double>& stress) {
  FakeInput in = one_voxel();
  in.set("stress", stress);
  in.set("density", 1500.0);
  in.set("velocity", std::vector<double>(3, 0.0));
  return in;
}

// τ/p = 0.4: the three stress ratios that must not be confused.
TEST(Stress, RatiosOfSimpleShear) {
  FakeInput in = under(simple_shear(100, 40));
  EXPECT_FLOAT_EQ(static_cast<float>(in.value("pressure")), 100.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(in.value("shear_stress")), 40.0F);
  EXPECT_NEAR(in.value("mu"), .4000, .5e-4);
  EXPECT_NEAR(in.value("mu"), .4, .4 * 0x1p-23);
  EXPECT_NEAR(std::sqrt(3) * in.value("shear_stress") / in.value("pressure"), .6928, .5e-4);
  EXPECT_NEAR(in.value("mu_mohr_coulomb"), .43644, .5e-5);
  EXPECT_NEAR(in.value("mu_mohr_coulomb"), .4 / std::sqrt(1 - .16), .44 * 0x1p-22);
  EXPECT_EQ(in.reasons_at({}), 0U);
}

// Of a stress that is not symmetric the whole deviator counts: σ':σ'/2 = (0.3² + 0.1²)/2 for σ_xz = 0.3, σ_zx = 0.1.
TEST(Stress, TheAntisymmetricPartCounts) {
  FakeInput in = one_voxel();
  in.set("stress", {-1, 0, .3, 0, -1, 0, .1, 0, -1});
  EXPECT_NEAR(in.value("shear_stress"), std::sqrt(.05), 1e-7);
  // … but the principal stresses are those of the symmetric part, with σ_xz = 0.2.
  EXPECT_NEAR(in.value("principal_stress", {}, 0), -.8, 1e-7);
  EXPECT_NEAR(in.value("principal_stress", {}, 2), -1.2, 1e-7);
}

TEST(Stress, PressureIsPositiveInCompression) {
  FakeInput in = one_voxel();
  in.set("stress", {-3, 5, 5, 5, -4, 5, 5, 5, -8});
  EXPECT_EQ(in.value("pressure"), 5);
}

TEST(Stress, RatiosNeedAPressureAboveItsMinimum) {
  const auto mu_at = [](double p, double least) {
    FakeInput in = under(simple_shear(p, 0.5));
    in.set_option("pressure", "pressure_min", least);
    in.set("shear_rate", 1.0);
    in.set("mean_diameter", 1.0);
    in.set("phi", 0.6);
    const double mu = in.value("mu");
    EXPECT_EQ(std::isnan(mu), in.has_reason(Reason::low_pressure));
    EXPECT_EQ(std::isnan(mu), std::isnan(in.value("fluidity")));
    EXPECT_EQ(std::isnan(mu), std::isnan(in.value("inertial_number")));
    EXPECT_TRUE(std::isfinite(in.value("pressure")));
    EXPECT_TRUE(std::isfinite(in.value("shear_stress")));
    return mu;
  };
  EXPECT_EQ(mu_at(2, 0), .25);
  EXPECT_TRUE(std::isnan(mu_at(0, 0)));
  EXPECT_TRUE(std::isnan(mu_at(-2, 0)));  // tension
  EXPECT_EQ(mu_at(2, 1.9), .25);
  EXPECT_TRUE(std::isnan(mu_at(2, 2)));  // at the minimum: undefined
  EXPECT_TRUE(std::isnan(mu_at(2, 3)));
}

// ρ (1e-5 |u|)² is what six digits leave of the kinetic pressure of a plug: 1500 × 1e-10 × 25 at 5 m/s. Where there is
// no material, nothing was rounded.
TEST(Stress, RatiosNeedAPressureAboveTheRoundingOfVelocities) {
  const double floor = 1500 * 1e-10 * 25;
  for (const auto& [pressure, resolution, defined] : {std::tuple{1.01 * floor, 1e-5, true},
                                                      {0.99 * floor, 1e-5, false},
                                                      {0.5 * floor, 0.5e-5, true},
                                                      {0.2 * floor, 0.0, true},
                                                      {0.0, 0.0, false}}) {
    FakeInput in = under(simple_shear(pressure, 0.1 * pressure));
    in.set("velocity", {3, 0, -4});
    in.set_option("velocity", "resolution", resolution);
    EXPECT_EQ(std::isfinite(in.value("mu")), defined) << pressure / floor;
    EXPECT_EQ(in.has_reason(Reason::low_pressure), !defined) << pressure / floor;
    EXPECT_EQ(std::isfinite(in.value("mu_mohr_coulomb")), defined) << pressure / floor;
  }
  EXPECT_EQ(under(simple_shear(2, 1)).value("pressure_floor"), 0);
  FakeInput outside = under(simple_shear(1e-30, 0));
  outside.set("density", 0.0);
  outside.set("velocity", std::vector<double>(3, static_cast<double>(nan)));
  outside.set_option("pressure", "pressure_min", 0.75);
  EXPECT_EQ(outside.value("pressure_floor"), 0.75);
}

TEST(Stress, InertialNumberTakesTheDensityOfTheGrains) {
  FakeInput in = one_voxel();
  in.set("shear_rate", 3.0);
  in.set("mean_diameter", 0.5);
  in.set("density", 1500.0);
  in.set("velocity", std::vector<double>(3, 0.0));
  in.set("phi", 0.625);
  in.set("pressure", 600.0);
  EXPECT_NEAR(in.value("inertial_number"), 3.0 * 0.5 * std::sqrt(2400.0 / 600.0), 3 * 0x1p-24);  // ρ_p = 2400
}

TEST(Stress, RegimesArePartedByTheInertialNumber) {
  const auto regime = [](double inertial_number) {
    FakeInput in = one_voxel();
    in.set("inertial_number", inertial_number);
    in.set_option("regime", "inertial_above", 0.25);
    return in.value("regime");
  };
  EXPECT_EQ(regime(0.0009), 0);
  EXPECT_EQ(regime(0.001001), 1);
  EXPECT_EQ(regime(0.25), 1);
  EXPECT_EQ(regime(0.2501), 2);
  EXPECT_TRUE(std::isnan(regime(std::nan(""))));
}

// Mohr-Coulomb: a principal stress that is tensile, zero, or positive only by rounding has no ratio.
TEST(Stress, MohrCoulombNeedsCompressionAllAround) {
  const auto ratio = [](std::vector<double> stress, double pressure_min, Reason expected) {
    FakeInput in = under(stress);
    in.set_option("pressure", "pressure_min", pressure_min);
    const double value = in.value("mu_mohr_coulomb");
    EXPECT_TRUE(std::isnan(value));
    EXPECT_TRUE(in.has_reason(expected));
  };
  ratio({-1, 0, 0, 0, .1, 0, 0, 0, -2}, 0, Reason::tensile_stress);
  ratio({-1, 0, 0, 0, 0, 0, 0, 0, -2}, 0, Reason::tensile_stress);
  ratio({-1, 0, 0, 0, -1e-8, 0, 0, 0, -2}, 0, Reason::tensile_stress);
  ratio({-1, 0, 0, 0, -1, 0, 0, 0, -2}, 1.5, Reason::low_pressure);
  ratio({0, 0, 0, 0, 0, 0, 0, 0, 0}, 0, Reason::low_pressure);
  ratio({0, 0, 0, 0, 0, 0, 0, 0, 0}, 0, Reason::tensile_stress);

  FakeInput isotropic = under(simple_shear(5, 0));
  EXPECT_EQ(isotropic.value("mu_mohr_coulomb"), 0);
}

}  // namespace
}  // namespace grainvdb::testing::stress_test
