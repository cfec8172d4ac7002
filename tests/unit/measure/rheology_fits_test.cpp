#include "measure/rheology_fits.hpp"

#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random.hpp"

namespace grainvdb::rheology_fits_test {
namespace {

using ::testing::HasSubstr;

constexpr double limit = 1000;
const SoftFrictionLaw friction{{.12, .55, .2}, .9};
const PackingLaw packing{3.28, .33, .636};

/// 40 inertial numbers between two, evenly spaced in their logarithm, and p* that varies against them.
RheologyData scene(double from, double to, double pressure) {
  RheologyData data;
  for (int k = 0; k < 40; ++k) {
    data.inertial_number.push_back(from * std::pow(to / from, k / 39.0));
    if (pressure > 0) data.soft_pressure.push_back(pressure * (1 + k * 7 % 40) / 40.0);
  }
  return data;
}

template <class Law>
RheologyData values_of(const Law& law, RheologyData data) {
  for (std::size_t k = 0; k < data.inertial_number.size(); ++k)
    data.value.push_back(law(data.inertial_number[k], data.soft_pressure.empty() ? 0 : data.soft_pressure[k]));
  return data;
}

TEST(FrictionLawFit, RecoversTheRigidLaw) {
  const FrictionLawFit found = fit_friction_law(values_of(friction, scene(1e-3, 2, 0)), limit);
  ASSERT_TRUE(found.fit.fitted()) << found.fit.refusal;
  EXPECT_NEAR(found.law.hard.mu_0, .12, 1e-8);
  EXPECT_NEAR(found.law.hard.mu_infinity, .55, 1e-8);
  EXPECT_NEAR(found.law.hard.i_0, .2, 1e-8);
  EXPECT_TRUE(std::isinf(found.law.p_0));
}

TEST(FrictionLawFit, RecoversTheSoftLaw) {
  const FrictionLawFit found = fit_friction_law(values_of(friction, scene(1e-3, 2, .1)), limit);
  ASSERT_TRUE(found.fit.fitted()) << found.fit.refusal;
  EXPECT_NEAR(found.law.hard.mu_0, .12, 1e-8);
  EXPECT_NEAR(found.law.hard.mu_infinity, .55, 1e-8);
  EXPECT_NEAR(found.law.hard.i_0, .2, 1e-8);
  EXPECT_NEAR(found.law.p_0, .9, 1e-7);
}

// 100 trials with noise of 0.005: 95.4 % within two standard errors, the share of which has a deviation of 0.021.
TEST(FrictionLawFit, LiesWithinTwoStandardErrorsInNoise) {
  testing::Random random(3);
  int within = 0;
  constexpr int trials = 100;
  for (int t = 0; t < trials; ++t) {
    RheologyData data = values_of(friction, scene(1e-3, 2, 0));
    data.error.assign(data.value.size(), .005);
    for (double& v : data.value) v += .005 * random.normal();
    const FrictionLawFit found = fit_friction_law(data, limit);
    ASSERT_TRUE(found.fit.fitted()) << found.fit.refusal;
    within += std::abs(found.law.hard.mu_0 - .12) <= 2 * found.error.hard.mu_0;
    within += std::abs(found.law.hard.mu_infinity - .55) <= 2 * found.error.hard.mu_infinity;
    within += std::abs(found.law.hard.i_0 - .2) <= 2 * found.error.hard.i_0;
  }
  EXPECT_NEAR(within / (3.0 * trials), .954, 3 * .021);
}

// Far below I₀ the law is μ₀ + (μ_∞-μ₀) I/I₀, far above it μ_∞ - (μ_∞-μ₀) I₀/I: two parameters each.
TEST(FrictionLawFit, RefusesOneSideOfItsInertialNumber) {
  for (const auto& [from, to] : {std::pair{1e-5, 1e-3}, std::pair{20.0, 200.0}}) {
    const FrictionLawFit found = fit_friction_law(values_of(friction, scene(from, to, 0)), limit);
    EXPECT_FALSE(found.fit.fitted()) << from;
    EXPECT_TRUE(std::isnan(found.law.hard.mu_0));
  }
}

TEST(FrictionLawFit, RefusesSoftnessThatDoesNotShow) {
  testing::Random random(5);
  RheologyData data = values_of([](double i, double) { return friction.hard(i); }, scene(1e-3, 2, 1e-6));
  data.error.assign(data.value.size(), .005);
  for (double& v : data.value) v += .005 * random.normal();
  EXPECT_FALSE(fit_friction_law(data, limit).fit.fitted());
}

TEST(PackingLawFit, RecoversItsParameters) {
  const PackingLawFit rigid = fit_packing_law(values_of(packing, scene(1e-3, 1, 0)), limit);
  ASSERT_TRUE(rigid.fit.fitted()) << rigid.fit.refusal;
  EXPECT_NEAR(rigid.law.nu_c, .636, 1e-9);
  EXPECT_NEAR(rigid.law.i_c, 3.28, 1e-7);
  const PackingLawFit soft = fit_packing_law(values_of(packing, scene(1e-3, 1, .05)), limit);
  ASSERT_TRUE(soft.fit.fitted()) << soft.fit.refusal;
  EXPECT_NEAR(soft.law.nu_c, .636, 1e-9);
  EXPECT_NEAR(soft.law.i_c, 3.28, 1e-7);
  EXPECT_NEAR(soft.law.p_c, .33, 1e-7);
}

TEST(PackingLawFit, SaysWhyItRefuses) {
  RheologyData flat = scene(1e-3, 1, 0);
  flat.value.assign(40, .6);
  flat.value[0] = .61;
  flat.value[39] = .6;
  flat.error.assign(40, .01);
  EXPECT_THAT(fit_packing_law(flat, limit).fit.refusal, HasSubstr("no finite I_c"));
  RheologyData few;
  few.inertial_number = {.1, .2};
  few.value = {.6, .59};
  EXPECT_THAT(fit_packing_law(few, limit).fit.refusal, HasSubstr("2 values for 2 parameters: at least 3"));
  EXPECT_THAT(fit_friction_law(few, limit).fit.refusal, HasSubstr("2 values for 3 parameters: at least 4"));
}

}  // namespace
}  // namespace grainvdb::rheology_fits_test
