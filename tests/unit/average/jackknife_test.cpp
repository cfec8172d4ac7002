#include "average/jackknife.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/topology.hpp"
#include "support/random.hpp"

namespace grainvdb::jackknife_test {
namespace {

using testing::Random;

/// A field on one full leaf, the values of f(offset) in one component and their squares in the other.
template <class F>
SparseField field_of(const F& f) {
  static const std::shared_ptr<const Topology> topology = [] {
    LeafMask mask;
    for (int v = 0; v < leaf_size; ++v) mask.set(v);
    return std::make_shared<const Topology>(std::vector<Coord>{{0, 0, 0}}, std::vector<LeafMask>{mask});
  }();
  SparseField field({"f", "1", 2, "", "", 0}, topology, Lattice(1, {0, 0, 0}));
  for (int v = 0; v < leaf_size; ++v) {
    const double x = f(v);
    field.leaf(0, 0)[v] = static_cast<float>(x);
    field.leaf(0, 1)[v] = static_cast<float>(x * x);
  }
  return field;
}
SparseField constant(double value) {
  return field_of([&](int) { return value; });
}

/// The jackknife of component c of a function of the mean, from the samples of each block.
double error_of(const std::vector<std::vector<double>>& blocks, int component) {
  double sum = 0;
  std::vector<std::size_t> frames;
  std::vector<double> sums;
  std::size_t n = 0;
  for (const auto& block : blocks) {
    sums.push_back(0);
    for (double x : block) sums.back() += x;
    sum += sums.back();
    frames.push_back(block.size());
    n += block.size();
  }
  const SparseField whole = constant(sum / static_cast<double>(n));
  Jackknife jackknife(whole, frames);
  for (std::size_t j = 0; j < blocks.size(); ++j)
    jackknife.leave_out(j, constant((sum - sums[j]) / static_cast<double>(n - frames[j])));
  return jackknife.error(0, component, 3);
}

/// As the formula is written for pseudo-values.
double pseudo_value_error(const std::vector<std::vector<double>>& blocks) {
  double n = 0, sum = 0;
  for (const auto& block : blocks)
    for (double x : block) {
      ++n;
      sum += x;
    }
  const double whole = sum / n * (sum / n);
  std::vector<double> h, without;
  double mean_pseudo = static_cast<double>(blocks.size()) * whole;
  for (const auto& block : blocks) {
    double rest = sum;
    for (double x : block) rest -= x;
    const auto m = static_cast<double>(block.size());
    h.push_back(n / m);
    without.push_back(rest / (n - m) * (rest / (n - m)));
    mean_pseudo -= (1 - m / n) * without.back();
  }
  double variance = 0;
  for (std::size_t j = 0; j < h.size(); ++j) {
    const double pseudo = h[j] * whole - (h[j] - 1) * without[j];
    variance += (pseudo - mean_pseudo) * (pseudo - mean_pseudo) / (h[j] - 1) / static_cast<double>(h.size());
  }
  return std::sqrt(variance);
}

/// Each field is rounded to 2⁻²⁴ of itself, and the error is a norm of the differences with weights up to √(h - 1).
double rounding(double largest, double most_blocks) {
  return 2 * 0x1p-24 * largest * std::sqrt(most_blocks);
}

// Block means 1, 2, 6 of two frames each: mean 3, squares of the deviations 4 + 1 + 9, error² = 14/(3 · 2).
TEST(Jackknife, OfAMeanByHand) {
  EXPECT_NEAR(error_of({{0, 2}, {1, 3}, {5, 7}}, 0), std::sqrt(14.0 / 6), rounding(6, 3));
}

// Blocks of one and three frames, N = 4: mean 2.5, block means 4 and 2, h = 4 and 4/3: error² = ½ (1.5²/3 + 0.5²/⅓).
TEST(Jackknife, OfUnequalBlocksByHand) {
  EXPECT_NEAR(error_of({{4}, {1, 2, 3}}, 0), std::sqrt(0.5 * (0.75 + 0.75)), rounding(4, 4));
}

// A ratio or any other function: as the pseudo-values of the literature give it.
TEST(Jackknife, OfAFunctionOfTheMean) {
  Random random(1);
  for (int n = 0; n < 20; ++n) {
    std::vector<std::vector<double>> blocks(2 + random.below(8));
    for (auto& block : blocks)
      for (std::size_t k = 0; k < 1 + random.below(4); ++k) block.push_back(random.uniform(1, 3));
    double all = 0, least = 100;
    for (const auto& block : blocks) {
      all += static_cast<double>(block.size());
      least = std::min(least, static_cast<double>(block.size()));
    }
    const double expected = pseudo_value_error(blocks);
    EXPECT_NEAR(error_of(blocks, 1), expected, rounding(9, all / least)) << n;
    EXPECT_GT(expected, 1e3 * rounding(9, all / least)) << n;
  }
}

// Independent frames of variance 1 in blocks of 1, 2 and 5: error² averages 1/8. A weighed sum of squares of normal
// numbers has a standard deviation of √2 of its mean at most; the mean of those of all voxels is off by less than 4 of
// its own.
TEST(Jackknife, IsUnbiasedForBlocksOfAnySize) {
  Random random(2);
  const std::vector<std::size_t> frames{1, 2, 5};
  std::vector<std::array<double, 3>> sums(leaf_size);
  for (auto& of_voxel : sums)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < frames[j]; ++k) of_voxel[j] += random.normal();
  const auto mean_without = [&](std::size_t left_out) {
    return field_of([&](int v) {
      double sum = 0, n = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        if (j == left_out) continue;
        sum += sums[static_cast<std::size_t>(v)][j];
        n += static_cast<double>(frames[j]);
      }
      return sum / n;
    });
  };
  const SparseField whole = mean_without(3);
  Jackknife jackknife(whole, frames);
  for (std::size_t j = 0; j < 3; ++j) jackknife.leave_out(j, mean_without(j));
  double mean = 0;
  for (int v = 0; v < leaf_size; ++v) mean += std::pow(jackknife.error(0, 0, v), 2) / leaf_size;
  EXPECT_NEAR(mean, 1.0 / 8, 4 * std::sqrt(2.0 / leaf_size) / 8);
}

TEST(Jackknife, IsUndefinedWhereAFieldIs) {
  const SparseField whole = constant(1);
  Jackknife jackknife(whole, {1, 1});
  jackknife.leave_out(0, constant(0.5));
  jackknife.leave_out(1, constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(std::isnan(jackknife.error(0, 0, 3)));
}

}  // namespace
}  // namespace grainvdb::jackknife_test
