#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::undefined_test {
namespace {

/// A sheared voxel in which everything is defined; tests spoil one field each.
FakeInput sheared() {
  FakeInput in = one_voxel();
  in.set("phi", 0.6);
  in.set("density", 1500.0);
  in.set("mean_diameter", 0.8e-3);
  in.set("velocity", {0.3, 0, 0.4});
  in.set("angular_velocity", {0, 20, 0});
  in.set("temperature", 0.04);
  in.set("rotational_fluctuation", 900.0);
  in.set("velocity_gradient", {0, 0, 50, 0, 0, 0, 0, 0, 0});
  in.set("stress", {-300, 0, 120, 0, -300, 0, 120, 0, -300});
  return in;
}

TEST(Fluidity, OfASimpleShear) {
  FakeInput in = sheared();
  const double g = 50 / .4;
  // Each field adds a rounding to float.
  EXPECT_NEAR(in.value("fluidity"), g, g * 0x1p-22);
  EXPECT_NEAR(in.value("gd_over_dv"), g * 0.8e-3 / 0.2, 0.5 * 0x1p-21);
  EXPECT_NEAR(in.value("rotational_temperature"), 0.64e-6 * 900 / 10, 5.8e-5 * 0x1p-21);
  EXPECT_NEAR(in.value("g_over_domega"), g / 30, 4.2 * 0x1p-21);
  EXPECT_NEAR(in.value("dv_over_d_domega"), 0.2 / (0.8e-3 * 30), 8.4 * 0x1p-22);
  // (A25): the ratio of the two dimensionless fluidities.
  EXPECT_NEAR(in.value("g_over_domega") / in.value("gd_over_dv"), in.value("dv_over_d_domega"), 8.4 * 0x1p-21);
  EXPECT_EQ(in.reasons_at({}), 0U);
}

TEST(Fluidity, ZeroShearRateIsAValue) {
  FakeInput in = sheared();
  in.set("velocity_gradient", std::vector<double>(9, 0.0));
  EXPECT_EQ(in.value("fluidity"), 0);
  EXPECT_EQ(in.value("gd_over_dv"), 0);
  EXPECT_EQ(in.reasons_at({}), 0U);
}

TEST(Fluidity, UndefinedUnderIsotropicStress) {
  // Exactly isotropic, and isotropic to the rounding of float.
  for (double noise_level : {0.0, 2e-5}) {
    FakeInput in = sheared();
    in.set("stress", {-300, 0, noise_level, 0, -300, 0, 0, 0, -300});
    EXPECT_TRUE(std::isfinite(in.value("mu")));
    for (const char* name : {"fluidity", "gd_over_dv", "g_over_domega"})
      EXPECT_TRUE(std::isnan(in.value(name))) << name;
    EXPECT_TRUE(in.has_reason(Reason::no_shear_stress));
  }
  FakeInput in = sheared();
  in.set_option("fluidity", "mu_min", 0.4001);
  EXPECT_TRUE(std::isnan(in.value("fluidity")));
  EXPECT_TRUE(in.has_reason(Reason::no_shear_stress));
}

// Negative, as a one-pass temperature can come out, zero, or within six digits of |u| = 0.5.
TEST(Fluidity, UndefinedWithoutFluctuation) {
  for (double t : {0.0, -1e-3, 0.99 * 2.5e-11}) {
    FakeInput in = sheared();
    in.set("temperature", t);
    EXPECT_TRUE(std::isnan(in.value("gd_over_dv")));
    EXPECT_TRUE(std::isfinite(in.value("fluidity")));
    EXPECT_TRUE(in.has_reason(Reason::no_fluctuation));
  }
  FakeInput cold = sheared();
  cold.set("temperature", 1.01 * 2.5e-11);
  EXPECT_TRUE(std::isfinite(cold.value("gd_over_dv")));
  EXPECT_TRUE(std::isfinite(cold.value("dv_over_d_domega")));
  FakeInput in = sheared();
  in.set_option("gd_over_dv", "temperature_min", 0.05);
  EXPECT_TRUE(std::isnan(in.value("gd_over_dv")));
  EXPECT_TRUE(std::isnan(in.value("dv_over_d_domega")));
}

// No fluctuation, one below its minimum, or within six digits of |ω| = 20.
TEST(Spin, UndefinedWithoutSpin) {
  for (const auto& [fluctuation, minimum] : {std::pair{0.0, 0.0}, {900.0, 1000.0}, {0.99 * 4e-8, 0.0}}) {
    FakeInput in = sheared();
    in.set("rotational_fluctuation", fluctuation);
    in.set_option("g_over_domega", "rotational_fluctuation_min", minimum);
    EXPECT_TRUE(std::isnan(in.value("g_over_domega")));
    EXPECT_TRUE(std::isnan(in.value("dv_over_d_domega")));
    EXPECT_TRUE(std::isfinite(in.value("rotational_temperature")));
    EXPECT_EQ(in.reasons_at({}), static_cast<std::uint32_t>(Reason::no_spin_fluctuation));
  }
}

TEST(Spin, ColdGrainsThatSpinHaveARatioOfZero) {
  FakeInput in = sheared();
  in.set("velocity", {0, 0, 0});
  in.set("temperature", 0.0);
  EXPECT_EQ(in.value("dv_over_d_domega"), 0);
  EXPECT_EQ(in.reasons_at({}), 0U);
  for (double t : {-1e-9, 0.99 * 2.5e-11}) {
    FakeInput none = sheared();
    none.set("temperature", t);
    EXPECT_TRUE(std::isnan(none.value("dv_over_d_domega")));
    EXPECT_TRUE(none.has_reason(Reason::no_fluctuation));
  }
}

// A voxel that only contacts reach: a stress, and neither velocity, diameter nor temperature.
TEST(Undefined, WithoutMaterialOnlyTheStressIsLeft) {
  FakeInput in = sheared();
  in.set("phi", 0.0);
  in.set("density", 0.0);
  for (const char* name : {"mean_diameter", "temperature", "rotational_fluctuation"})
    in.set(name, static_cast<double>(nan));
  for (const char* name : {"velocity", "angular_velocity"})
    in.set(name, std::vector<double>(3, static_cast<double>(nan)));
  in.set("velocity_gradient", std::vector<double>(9, static_cast<double>(nan)));
  for (const char* name : {"shear_rate", "inertial_number", "fluidity", "gd_over_dv", "rotational_temperature",
                           "g_over_domega", "dv_over_d_domega", "coaxiality_angle"})
    EXPECT_TRUE(std::isnan(in.value(name))) << name;
  for (const char* name : {"pressure", "shear_stress", "mu", "mu_mohr_coulomb"})
    EXPECT_TRUE(std::isfinite(in.value(name))) << name;
}

TEST(Undefined, VanishingPackingFractionHasNoGrainDensity) {
  FakeInput in = sheared();
  in.set("phi", 0.0);
  in.set("density", 0.0);
  EXPECT_TRUE(std::isnan(in.value("inertial_number")));
  EXPECT_TRUE(in.has_reason(Reason::no_material));
}

// A NaN in any single input makes the result NaN and never a fresh reason.
TEST(Undefined, NaNPassesThroughEveryStage) {
  FakeInput model = sheared();
  for (const Stage& stage : model.registry().stages()) {
    if (stage.name == "velocity" || stage.name == "angular_velocity" || stage.name.ends_with("velocity_gradient"))
      continue;
    if (stage.name == "pressure_floor") continue;  // which is pressure_min where there is no material
    if (stage.name == "spot_drift") continue;      // which differentiates, as velocity_gradient does
    const std::vector<std::string> needs = stage.needs(model.settings()).fields;
    for (const std::string& spoilt : needs) {
      FakeInput in = sheared();
      for (const std::string& need : needs) in.derive(need);
      const std::uint32_t before = in.reasons_at({});
      std::vector<double> values = in.values(spoilt);
      values.back() = static_cast<double>(nan);
      in.set(spoilt, values);
      for (double v : in.values(stage.name)) EXPECT_TRUE(std::isnan(v)) << stage.name << " without " << spoilt;
      EXPECT_EQ(in.reasons_at({}), before) << stage.name << " without " << spoilt;
    }
  }
}

}  // namespace
}  // namespace grainvdb::testing::undefined_test
