// Weighted samples, histograms and binned curves.
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "measure/binned_curve.hpp"
#include "measure/histogram.hpp"
#include "measure/voxel_values.hpp"
#include "measure/weighted_sample.hpp"
#include "support/random.hpp"

namespace grainvdb::testing::statistics_test {
namespace {

TEST(WeightedSample, OfNumbersByHand) {
  WeightedSample s;
  s.add(1, 1);
  s.add(4, 2);
  s.add(2, 1);
  s.add(100, 0);
  s.add(std::nan(""), 5);
  EXPECT_EQ(s.size(), 3U);
  EXPECT_DOUBLE_EQ(s.mean(), 11.0 / 4);
  EXPECT_DOUBLE_EQ(s.effective_size(), 16.0 / 6);
  const double squares = 1.75 * 1.75 + 2 * 1.25 * 1.25 + 0.75 * 0.75;
  EXPECT_DOUBLE_EQ(s.spread(), std::sqrt(squares / (4 - 6.0 / 4)));
  EXPECT_DOUBLE_EQ(s.mean_error(1), s.spread() / std::sqrt(16.0 / 6));
  EXPECT_DOUBLE_EQ(s.mean_error(0.75), s.spread() / std::sqrt(2));
  EXPECT_DOUBLE_EQ(s.mean_error(1e-9), s.spread());
  // Middles of the weights of 1, 2, 4 lie at 0.5, 1.5, 3 of 4.
  EXPECT_DOUBLE_EQ(s.quantile(0), 1);
  EXPECT_DOUBLE_EQ(s.quantile(1 / 8.0), 1);
  EXPECT_DOUBLE_EQ(s.quantile(1 / 4.0), 1.5);
  EXPECT_DOUBLE_EQ(s.quantile(3 / 8.0), 2);
  EXPECT_DOUBLE_EQ(s.quantile(2.25 / 4), 3);
  EXPECT_DOUBLE_EQ(s.quantile(1), 4);
}

TEST(WeightedSample, OfNothingIsUndefined) {
  const WeightedSample s;
  EXPECT_TRUE(std::isnan(s.mean()));
  EXPECT_TRUE(std::isnan(s.spread()));
  EXPECT_TRUE(std::isnan(s.quantile(0.5)));
}

// Equal weights whose number is that of the voxels give what is known of a mean of n numbers.
TEST(WeightedSample, EqualWeightsAreTheUsualStatistics) {
  WeightedSample s;
  for (double v : {2.0, 4.0, 6.0, 8.0}) s.add(v, 0.3);
  EXPECT_DOUBLE_EQ(s.mean(), 5);
  EXPECT_NEAR(s.spread(), std::sqrt(20.0 / 3), 1e-15);
  EXPECT_NEAR(s.mean_error(1), std::sqrt(20.0 / 3) / 2, 1e-15);
}

TEST(Independence, IsTheVolumeOfAVoxelOverThatOfTheKernel) {
  EXPECT_NEAR(independence(0.5, LucyKernel(3)), 0.125 * 455 / (176 * M_PI * 27), 1e-15);
  EXPECT_EQ(independence(10, LucyKernel(3)), 1);
}

TEST(Histogram, SharesByHand) {
  Histogram h(0, 2, 4);
  for (double v : {0.0, 0.4, 0.5, 2.0}) h.add(v, 1);
  h.add(-0.1, 2);
  h.add(3, 2);
  h.add(std::nan(""), 1);
  EXPECT_DOUBLE_EQ(h.density(0), 2 / (8 * 0.5));
  EXPECT_DOUBLE_EQ(h.density(1), 1 / (8 * 0.5));
  EXPECT_DOUBLE_EQ(h.density(2), 0);
  EXPECT_DOUBLE_EQ(h.density(3), 1 / (8 * 0.5));
  EXPECT_DOUBLE_EQ(h.outside(), 0.5);
  EXPECT_DOUBLE_EQ(h.centre(3), 1.75);
  EXPECT_THROW(Histogram(1, 1, 3), std::invalid_argument);
  EXPECT_THROW(Histogram(0, 1, 0), std::invalid_argument);
}

TEST(BinnedCurve, BinsLieAtMultiplesOfTheirWidth) {
  BinnedCurve c(0.5);
  c.add(-0.1, 1);
  c.add(0.1, 2);
  c.add(0.4, 6);
  c.add(std::nan(""), 3);
  c.add(0.2, std::nan(""));
  const auto bins = c.bins();
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_DOUBLE_EQ(bins[0].x, -0.25);
  EXPECT_DOUBLE_EQ(bins[1].x, 0.25);
  EXPECT_EQ(bins[1].y.count(), 2U);
  EXPECT_DOUBLE_EQ(bins[1].y.mean(), 4);
  EXPECT_DOUBLE_EQ(bins[1].y.spread(), std::sqrt(8.0));
  EXPECT_TRUE(std::isnan(bins[0].y.spread()));
  EXPECT_THROW(BinnedCurve(0), std::invalid_argument);
}

TEST(BinnedCurve, ALawCollapses) {
  Random random(5);
  BinnedCurve steps(0.1);
  for (int n = 0; n < 5000; ++n) {
    const double x = random.uniform();
    steps.add(x, std::floor(10 * x) * std::floor(10 * x));
  }
  EXPECT_DOUBLE_EQ(steps.collapse(), 1);

  // A straight line in B bins of m even places each: Σ(y - bin)² = B m(m²-1)/12, Σ(y - mean)² = N(N²-1)/12, N = mB, so
  // that 1 - collapse = m(m+1)/(N(N+1)), which tends to 1/B².
  constexpr int m = 50, b = 10, n = m * b;
  BinnedCurve line(0.1);
  for (int k = 0; k < n; ++k) line.add((k + 0.5) / n, k);
  EXPECT_NEAR(line.collapse(), 1 - m * (m + 1.0) / (n * (n + 1.0)), 1e-14);
}

// The mean over runs of noise is 0 within its error, the spread between them what collapse_noise says (known to
// 1/√(2·400) = 3.5 %).
TEST(BinnedCurve, NoiseDoesNot) {
  Random random(13);
  constexpr int runs = 400;
  RunningMoments collapse;
  double expected = 0;
  for (int r = 0; r < runs; ++r) {
    BinnedCurve c(0.1);
    for (int n = 0; n < 200; ++n) c.add(random.uniform(), random.normal());
    collapse.add(c.collapse());
    expected = c.collapse_noise();
  }
  EXPECT_NEAR(collapse.mean(), 0, 3 * expected / std::sqrt(runs));
  EXPECT_NEAR(collapse.spread(), expected, 0.12 * expected);
}

TEST(BinnedCurve, TooFewPointsTellNothing) {
  BinnedCurve c(0.1);
  c.add(0.05, 1);
  c.add(0.15, 2);
  EXPECT_TRUE(std::isnan(c.collapse()));
  EXPECT_TRUE(std::isnan(c.collapse_noise()));
}

// Sums of squares of numbers near 1e8 would leave nothing of a spread of 1.
TEST(RunningMoments, DoNotCancel) {
  RunningMoments m;
  for (int n = 0; n < 1000; ++n) m.add(1e8 + (n % 2 == 0 ? 1 : -1));
  EXPECT_NEAR(m.spread(), std::sqrt(1000 / 999.0), 1e-6);
}

}  // namespace
}  // namespace grainvdb::testing::statistics_test
