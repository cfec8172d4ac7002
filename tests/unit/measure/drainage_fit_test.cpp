#include "measure/drainage_fit.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"
#include "support/random.hpp"

namespace grainvdb::testing::drainage_fit_test {
namespace {

constexpr KinematicFlow flow{2.28, 1.7};

/// The flow at whole places |x| ≤ half_width, 5 ≤ z ≤ 40, with normal noise of standard deviation `noise`.
std::vector<DrainagePoint> drainage(double half_width, double rise, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<DrainagePoint> points;
  for (double z = 5; z <= 40; z += 1)
    for (double x = -half_width; x <= half_width; x += 1)
      points.push_back({x, z, flow.downward(x, z + rise) + noise * random.normal()});
  return points;
}

TEST(FitKinematic, RecoversACleanFlow) {
  const KinematicEstimate fit = fit_kinematic(drainage(15, 0, 0, 1), Origin::slot);
  EXPECT_TRUE(fit.refusal.empty()) << fit.refusal;
  EXPECT_NEAR(fit.b.value, 2.28, 1e-6 * 2.28);
  EXPECT_NEAR(fit.discharge.value, 1.7, 1e-6 * 1.7);
  EXPECT_EQ(fit.rise.value, 0);
  EXPECT_LT(fit.b.error, 1e-6);
  EXPECT_LT(fit.rms, 1e-9);
}

TEST(FitKinematic, RecoversTheOriginToo) {
  const KinematicEstimate fit = fit_kinematic(drainage(15, 3, 0, 1), Origin::fitted);
  EXPECT_TRUE(fit.refusal.empty()) << fit.refusal;
  EXPECT_NEAR(fit.b.value, 2.28, 1e-6 * 2.28);
  EXPECT_NEAR(fit.discharge.value, 1.7, 1e-6 * 1.7);
  EXPECT_NEAR(fit.rise.value, 3, 1e-5);
  // Taken to rise from the slot, the same flow spreads too much.
  EXPECT_GT(fit_kinematic(drainage(15, 3, 0, 1), Origin::slot).b.value, 2.4);
}

// Velocities are 0.06 to 0.14 in the middle: noise of 5 % of that leaves b within 1 %, and 60 deviations in units of
// the errors have a mean square of 1 ± √(2/60).
TEST(FitKinematic, ErrorsAreThoseOfTheNoise) {
  double squares = 0;
  constexpr int runs = 30;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    const KinematicEstimate fit = fit_kinematic(drainage(15, 0, 0.005, seed), Origin::slot);
    EXPECT_NEAR(fit.b.value, 2.28, 0.02 * 2.28);
    squares += std::pow((fit.b.value - 2.28) / fit.b.error, 2) +
               std::pow((fit.discharge.value - 1.7) / fit.discharge.error, 2);
  }
  EXPECT_NEAR(squares / (2 * runs), 1, 4 * std::sqrt(2.0 / (2 * runs)));
  EXPECT_NEAR(fit_kinematic(drainage(15, 0, 0.005, 1), Origin::slot).b.value, 2.28, 0.01 * 2.28);
}

TEST(FitKinematic, PointsThatTellTheSameWidenErrors) {
  std::vector<DrainagePoint> points = drainage(15, 0, 0.005, 1);
  const double all = fit_kinematic(points, Origin::slot).b.error;
  for (DrainagePoint& p : points) p.independent = 0.04;
  EXPECT_NEAR(fit_kinematic(points, Origin::slot).b.error, 5 * all, 1e-9 * all);
}

TEST(FitKinematic, RefusesWhatDoesNotFlow) {
  std::vector<DrainagePoint> still = drainage(5, 0, 0, 1);
  for (DrainagePoint& p : still) p.v = 0;
  EXPECT_FALSE(fit_kinematic(still, Origin::slot).refusal.empty());
  EXPECT_FALSE(fit_kinematic({}, Origin::slot).refusal.empty());
  EXPECT_TRUE(std::isnan(fit_kinematic(still, Origin::slot).b.value));
}

// Cut off at |x| = 15, where at z = 40 the profile has a standard deviation of 13.5, moments are far off.
TEST(FitProfiles, GaussiansAreExactWhereMomentsAreCutOff) {
  const std::vector<DrainageProfile> profiles = fit_profiles(drainage(15, 0, 0, 1));
  ASSERT_EQ(profiles.size(), 36U);
  for (const DrainageProfile& p : profiles) {
    EXPECT_NEAR(p.variance.value, flow.variance(p.z), 1e-7 * flow.variance(p.z)) << p.z;
    EXPECT_NEAR(p.middle.value, 0, 1e-7);
    EXPECT_NEAR(p.peak.value, flow.downward(0, p.z), 1e-8);
  }
  EXPECT_LT(profiles.back().moment_variance, 0.5 * flow.variance(40));
  const std::vector<DrainageProfile> wide = fit_profiles(drainage(120, 0, 0, 1));
  for (const DrainageProfile& p : wide) EXPECT_NEAR(p.moment_variance, flow.variance(p.z), 1e-9 * p.moment_variance);
}

TEST(FitWidth, GrowsByTwoB) {
  const WidthGrowth growth = fit_width(fit_profiles(drainage(15, 3, 0, 1)));
  EXPECT_TRUE(growth.refusal.empty()) << growth.refusal;
  EXPECT_NEAR(growth.b.value, 2.28, 1e-6 * 2.28);
  EXPECT_NEAR(growth.offset.value, 2 * 2.28 * 3, 1e-5);
}

TEST(FitWidth, ErrorsAreThoseOfTheNoise) {
  double squares = 0;
  constexpr int runs = 30;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    const WidthGrowth growth = fit_width(fit_profiles(drainage(30, 0, 0.002, seed)));
    EXPECT_NEAR(growth.b.value, 2.28, 0.05 * 2.28);
    squares += std::pow((growth.b.value - 2.28) / growth.b.error, 2);
  }
  EXPECT_LT(squares / runs, 1 + 4 * std::sqrt(2.0 / runs));
  EXPECT_GT(squares / runs, 0.3);
}

TEST(FitWidth, RefusesTwoHeights) {
  std::vector<DrainagePoint> points = drainage(15, 0, 0, 1);
  std::erase_if(points, [](const DrainagePoint& p) { return p.z > 6; });
  const WidthGrowth growth = fit_width(fit_profiles(points));
  EXPECT_EQ(growth.refusal, "2 heights have a profile with a width: at least 3 are needed");
  EXPECT_TRUE(std::isnan(growth.b.value));
}

// Without a Gaussian there is no width: a flow up is none, nor are three points enough.
TEST(FitProfiles, LeaveOutWhatIsNoProfile) {
  std::vector<DrainagePoint> points{{-1, 1, -1}, {0, 1, -2}, {1, 1, -1}, {0, 2, 1}, {1, 2, 0.5}, {2, 2, 0.2}};
  for (const DrainageProfile& p : fit_profiles(points)) EXPECT_TRUE(std::isnan(p.variance.value));
}

}  // namespace
}  // namespace grainvdb::testing::drainage_fit_test
