#include "measure/fluidity_fit.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random.hpp"

namespace grainvdb::fluidity_fit_test {
namespace {

using ::testing::HasSubstr;

constexpr double limit = 1000;

/// Values of a law at 40 packing fractions.
FluidityData values_of(const FluidityLaw& law, double from, double to) {
  FluidityData data;
  for (int n = 0; n < 40; ++n) {
    data.phi.push_back(from + (to - from) * n / 39);
    data.value.push_back(law(data.phi.back()));
  }
  return data;
}

/// Both branches, down to gd/δv = 0.
FluidityData both_branches(const FluidityLaw& law) {
  return values_of(law, law.b - 0.08, law.zero());
}

std::array<double, 4> list(const FluidityLaw& law) {
  return {law.a, law.b, law.c, law.d};
}

TEST(FluidityFit, RecoversTableFour) {
  for (const FluidityFit& row : fluidity_fits) {
    const FluidityLawFit found = fit_fluidity_law(both_branches(row.law), limit);
    ASSERT_TRUE(found.fit.fitted()) << row.name << ": " << found.fit.refusal;
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_NEAR(list(found.law)[j], list(row.law)[j], 1e-6 * list(row.law)[j]) << row.name << " parameter " << j;
    EXPECT_LT(found.fit.condition, 200) << row.name;
  }
}

TEST(FluidityFit, RecoversThreeParametersWithTheFourthHeld) {
  const FluidityLawFit found = fit_fluidity_law_with(1.54e-4, both_branches(zhang_kamrin_law), limit);
  ASSERT_TRUE(found.fit.fitted()) << found.fit.refusal;
  for (std::size_t j = 0; j < 4; ++j)
    EXPECT_NEAR(list(found.law)[j], list(zhang_kamrin_law)[j], 1e-6 * list(zhang_kamrin_law)[j]);
  EXPECT_EQ(found.error.c, 0);
}

// Nine laws, 50 trials each, with noise of 0.01. Of normal deviates 95.4 % lie within two standard errors; of 450
// independent trials that share has a standard deviation of 0.010.
TEST(FluidityFit, LiesWithinTwoStandardErrorsInNoise) {
  testing::Random random(7);
  int within = 0, all = 0;
  for (const FluidityFit& row : fluidity_fits)
    for (int trial = 0; trial < 50; ++trial) {
      FluidityData data = both_branches(row.law);
      data.error.assign(data.phi.size(), 0.01);
      for (double& value : data.value) value += 0.01 * random.normal();
      const FluidityLawFit found = fit_fluidity_law(data, limit);
      ASSERT_TRUE(found.fit.fitted()) << row.name << ": " << found.fit.refusal;
      for (std::size_t j = 0; j < 4; ++j, ++all)
        if (std::abs(list(found.law)[j] - list(row.law)[j]) <= 2 * list(found.error)[j]) ++within;
    }
  EXPECT_NEAR(static_cast<double>(within) / all, 0.954, 0.03);
}

// Physics section 7: with the plateau alone one combination is determined, with the dense branch alone two.
TEST(FluidityFit, RefusesOneBranchAlone) {
  for (const FluidityFit& row : fluidity_fits) {
    const double w = std::sqrt(row.law.c);
    for (const auto& [from, to] :
         {std::pair{row.law.b - 0.12, row.law.b - 4 * w}, std::pair{row.law.b + 2.5 * w, row.law.b + 2.5 * w + 0.05}}) {
      const FluidityLawFit found = fit_fluidity_law(values_of(row.law, from, to), limit);
      EXPECT_FALSE(found.fit.fitted()) << row.name << " from " << from << " to " << to;
      EXPECT_LT(found.fit.rank, 4U) << row.name;
      EXPECT_TRUE(std::isnan(found.law.a) && std::isnan(found.error.d)) << row.name;
    }
  }
}

TEST(FluidityFit, RefusesOneBranchInNoise) {
  testing::Random random(11);
  const FluidityLaw law = fluidity_fits[3].law;
  for (int trial = 0; trial < 20; ++trial) {
    FluidityData data = values_of(law, 0.5, 0.55);
    data.error.assign(data.phi.size(), 0.02);
    for (double& value : data.value) value += 0.02 * random.normal();
    EXPECT_FALSE(fit_fluidity_law(data, limit).fit.fitted());
  }
}

TEST(FluidityFit, SaysWhyItRefuses) {
  FluidityData rising;
  for (int n = 0; n < 10; ++n) {
    rising.phi.push_back(0.5 + 0.01 * n);
    rising.value.push_back(1 + 0.1 * n);
  }
  EXPECT_THAT(fit_fluidity_law(rising, limit).fit.refusal, HasSubstr("does not fall with phi"));
  FluidityData few = values_of(zhang_kamrin_law, 0.55, 0.62);
  few.phi.resize(4);
  few.value.resize(4);
  EXPECT_THAT(fit_fluidity_law(few, limit).fit.refusal, HasSubstr("4 values of gd/dv for 4 parameters: at least 5"));
}

}  // namespace
}  // namespace grainvdb::fluidity_fit_test
