// How often standard errors tell the truth: series of known correlation in thousands of voxels, through the sums by
// blocks and the jackknife.
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "average/jackknife.hpp"
#include "average/leave_one_out.hpp"
#include "support/random.hpp"
#include "unit/average/support.hpp"

namespace grainvdb::coverage_test {
namespace {

using testing::Random;

constexpr std::size_t leaves = 16;
constexpr std::size_t voxels = leaves * leaf_size;
constexpr std::size_t blocks = 8;
/// Nineteen of twenty means of eight blocks lie within so many standard errors: Student's t with seven degrees.
constexpr double t95 = 2.364624;

/// The probability that |t| < x for Student's t with seven degrees of freedom, by the midpoint rule.
double within(double x) {
  const double norm = std::tgamma(4.0) / (std::sqrt(7 * std::numbers::pi) * std::tgamma(3.5));
  constexpr int steps = 10'000;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double t = (k + 0.5) * x / steps;
    sum += 2 * norm * std::pow(1 + t * t / 7, -4) * x / steps;
  }
  return sum;
}

std::shared_ptr<const Topology> full_leaves() {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks(leaves);
  for (std::size_t l = 0; l < leaves; ++l) {
    origins.push_back({static_cast<std::int32_t>(8 * l), 0, 0});
    for (int v = 0; v < leaf_size; ++v) masks[l].set(v);
  }
  return std::make_shared<const Topology>(std::move(origins), std::move(masks));
}

SparseField field_of(const MomentMeans& means, const Moment& m) {
  SparseField field({"f", "1", 1, "", "", 0}, means.topology(), Lattice(1, {0, 0, 0}));
  for (std::size_t l = 0; l < leaves; ++l)
    for (int v = 0; v < leaf_size; ++v) field.leaf(l)[v] = static_cast<float>(means.block(l, m, 0)[v]);
  return field;
}

/// Numbers of mean 0 and variance 1, each correlated by `memory` with the one before.
class Series {
 public:
  explicit Series(double memory) : memory_(memory), now_(voxels) {
    for (double& x : now_) x = random_.normal();
  }
  /// The variance of the mean of n numbers.
  double variance_of_mean(std::size_t n) const {
    const auto length = static_cast<double>(n);
    double sum = length;
    for (std::size_t k = 1; k < n; ++k) sum += 2 * (length - static_cast<double>(k)) * std::pow(memory_, k);
    return sum / (length * length);
  }
  const std::vector<double>& next() {
    for (double& x : now_) x = memory_ * x + std::sqrt(1 - memory_ * memory_) * random_.normal();
    return now_;
  }

 private:
  double memory_;
  Random random_{3};
  std::vector<double> now_;
};

struct Outcome {
  double mean_square = 0;  ///< of the standard errors
  double covered = 0;      ///< the share of voxels whose true mean, 0, lies within t95 standard errors
};

/// Blocks of `length` frames.
Outcome estimate(Series& series, std::size_t length) {
  const MomentPtr m = moment("m");
  const auto topology = full_leaves();
  WindowSums sums({m}, {m});
  LeafBuffers frame(topology, 1);
  for (std::size_t k = 0; k < blocks * length; ++k) {
    if (k % length == 0) sums.begin_block(k / length);
    const std::vector<double>& values = series.next();
    for (std::size_t l = 0; l < leaves; ++l) std::copy_n(values.data() + l * leaf_size, leaf_size, frame.block(l, 0));
    sums.add(m, frame, 0);
    sums.end_frame();
  }
  sums.end_sweep();
  const MomentMeans means = sums.means();
  const SparseField whole = field_of(means, *m);
  Jackknife jackknife(whole, std::vector<std::size_t>(blocks, length));
  LeaveOneOut others(sums, means);
  for (std::size_t b = 0; b < blocks; ++b) jackknife.leave_out(b, field_of(others.without(b), *m));
  Outcome outcome;
  for (std::size_t l = 0; l < leaves; ++l)
    for (int v = 0; v < leaf_size; ++v) {
      const double error = jackknife.error(l, 0, v);
      outcome.mean_square += error * error / voxels;
      outcome.covered += std::abs(static_cast<double>(whole.leaf(l)[v])) < t95 * error ? 1.0 / voxels : 0;
    }
  return outcome;
}

/// What the mean square of the errors should be: blocks of variance v(L) about a mean of variance v(N), (v(L) -
/// v(N))/(B - 1).
double expected_square(const Series& series, std::size_t length) {
  return (series.variance_of_mean(length) - series.variance_of_mean(blocks * length)) / (blocks - 1.0);
}

/// A sum of squares of normal numbers has a standard deviation of √2 of its mean at most: four of those of the mean.
const double square_tolerance = 4 * std::sqrt(2.0 / voxels);
/// Four standard deviations of a share near 0.95, or of any share.
const double share_tolerance = 4 * std::sqrt(0.95 * 0.05 / voxels);
const double any_tolerance = 4 * 0.5 / std::sqrt(static_cast<double>(voxels));

TEST(Coverage, OfIndependentFrames) {
  for (const std::size_t length : {1U, 5U}) {
    Series series(0);
    const Outcome outcome = estimate(series, length);
    const double truth = series.variance_of_mean(blocks * length);
    EXPECT_NEAR(outcome.mean_square, truth, square_tolerance * truth) << length;
    EXPECT_NEAR(outcome.covered, within(t95), share_tolerance) << length;
  }
  EXPECT_NEAR(within(t95), 0.95, 1e-5);
}

// Correlated over five frames: blocks of twenty times that give 6 % too small a square, and as good as full coverage.
TEST(Coverage, OfFramesThatAreCorrelatedForLessThanABlock) {
  constexpr std::size_t length = 100;
  Series series(std::exp(-1.0 / 5));
  const Outcome outcome = estimate(series, length);
  const double expected = expected_square(series, length);
  const double truth = series.variance_of_mean(blocks * length);
  EXPECT_NEAR(outcome.mean_square, expected, square_tolerance * expected);
  EXPECT_GT(expected, 0.93 * truth);
  EXPECT_GT(outcome.covered, within(t95 * std::sqrt(expected / truth)) - share_tolerance);
  EXPECT_LT(outcome.covered, within(t95) + share_tolerance);
}

// Blocks shorter than the correlation miss most of it: by as much as they should, and the mean lies outside for most.
TEST(Coverage, IsLostWhereBlocksAreShorterThanTheCorrelation) {
  constexpr std::size_t length = 2;
  Series series(std::exp(-1.0 / 20));
  const Outcome outcome = estimate(series, length);
  const double expected = expected_square(series, length);
  EXPECT_NEAR(outcome.mean_square, expected, square_tolerance * expected);
  EXPECT_LT(expected, 0.1 * series.variance_of_mean(blocks * length));
  EXPECT_LT(outcome.covered, 0.5 + any_tolerance);
}

}  // namespace
}  // namespace grainvdb::coverage_test
