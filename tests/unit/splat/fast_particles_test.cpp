#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "bin/buckets.hpp"
#include "splat/bricks.hpp"
#include "splat/candidates.hpp"
#include "splat/records.hpp"
#include "splat/splat.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::fast_particles_test {
namespace {

class FastParticleSplat : public testing::TestWithParam<Scene> {
 protected:
  void SetUp() override { make(60); }
  void make(std::size_t points) {
    x = scene.random_positions(points, 21);
    count = x[0].size();
    buckets = bin_points(lattice, x, scene.cutoff);
    topology = particle_topology(lattice, kernel, buckets);
  }

  /// Compares every active voxel with the sums in double, relative to the sum of |terms|.
  void expect_equal(const std::vector<double>& q, const std::vector<int>& weight_of, double tolerance) {
    const int channels = static_cast<int>(weight_of.size());
    std::vector<double> magnitude = q;
    for (double& v : magnitude) v = std::abs(v);
    const LeafBuffers exact = splat_particles(lattice, kernel, buckets, topology, q, channels);
    const LeafBuffers scale = splat_particles(lattice, kernel, buckets, topology, magnitude, channels);
    const LeafBuffers fast = splat_particles_fast(lattice, kernel, buckets, topology, q, weight_of);
    expect_zero_where_inactive(fast);
    for (std::size_t leaf = 0; leaf < topology->leaf_count(); ++leaf)
      topology->mask(leaf).for_each([&](int v) {
        for (int c = 0; c < channels; ++c)
          EXPECT_NEAR(fast.block(leaf, c)[v], exact.block(leaf, c)[v], tolerance * scale.block(leaf, c)[v])
              << "channel " << c << " of " << channels << ", " << splat_target();
      });
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  Columns3 x;
  std::size_t count = 0;
  Buckets buckets;
  std::shared_ptr<const Topology> topology;
};

// The bar of the project, rims included: a voxel that only the rim of one support reaches must be right too.
constexpr double bar = 1e-5;

TEST_P(FastParticleSplat, EqualsTheSumsInDoubleForAnyNumberOfChannels) {
  for (const int channels : {1, 2, 3, 4, 5, 8, 9, 14, 15, 23, 24, 25, 40})
    expect_equal(random_values(count * static_cast<std::size_t>(channels), 22),
                 std::vector<int>(static_cast<std::size_t>(channels), -1), bar);
}

TEST_P(FastParticleSplat, EqualsTheSumsInDoubleWithFewAndManyParticles) {
  for (const std::size_t points : {std::size_t{1}, std::size_t{2}, std::size_t{17}, std::size_t{700}}) {
    make(points);
    expect_equal(random_values(count * 4, 23), {-1, -1, -1, -1}, bar);
  }
}

TEST_P(FastParticleSplat, EveryInstructionSetGivesTheSame) {
  const auto q = random_values(count * 5, 24);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    expect_equal(q, {-1, -1, -1, -1, -1}, bar);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST_P(FastParticleSplat, BricksOfEitherSizeGiveTheSameSums) {
  constexpr std::size_t channels = 14;
  const double reach = scene.cutoff / scene.voxel;
  const auto q = random_values(count * channels, 30);
  const Records records(buckets, q, std::vector<int>(channels, -1));
  for (std::size_t leaf = 0; leaf < topology->leaf_count(); ++leaf) {
    LeafCandidates candidates;
    gather_candidates(buckets, topology->origin(leaf), reach, candidates);
    LeafRecords values;
    records.gather(topology->origin(leaf), candidates, values);
    const auto sums = [&](bool halves, LeafSums& out) {
      splat_leaf({&candidates, values.values.data(), records.stride(), channels, static_cast<float>(1 / reach), halves},
                 topology->mask(leaf), out);
    };
    LeafSums whole, half;
    sums(false, whole);
    sums(true, half);
    topology->mask(leaf).for_each([&](int v) {
      for (int row = 0; row <= static_cast<int>(channels); ++row)
        EXPECT_EQ(whole.sums.at(row, v), half.sums.at(row, v));
    });
  }
}

TEST_P(FastParticleSplat, LosesNothingOfASmallVariationAboutALargeMean) {
  // Channel 1 is w q with q = 1e4 + variation: in single precision the variation would drown in rounding of 1e4 (6e-4).
  const double mean = 1e4;
  const auto weight = random_values(count, 25);
  const auto variation = random_values(count, 26);
  std::vector<double> q(2 * count);
  for (std::size_t p = 0; p < count; ++p) {
    q[2 * p] = 1.5 + weight[p];
    q[2 * p + 1] = q[2 * p] * (mean + variation[p]);
  }
  const LeafBuffers exact = splat_particles(lattice, kernel, buckets, topology, q, 2);
  const LeafBuffers fast = splat_particles_fast(lattice, kernel, buckets, topology, q, std::vector<int>{-1, 0});
  for (std::size_t leaf = 0; leaf < topology->leaf_count(); ++leaf)
    topology->mask(leaf).for_each([&](int v) {
      const double expected = exact.block(leaf, 1)[v] / exact.block(leaf, 0)[v];
      // Means of values in [-1, 1]: the bar counts against 1. The local reference differs from the voxel's mean by up
      // to 2, and both sums carry the error of their weights.
      EXPECT_NEAR(fast.block(leaf, 1)[v] / fast.block(leaf, 0)[v], expected, 4 * bar);
    });
}

TEST_P(FastParticleSplat, TheScaleOfTheValuesDoesNotMatter) {
  // 1e-60 and 1e60 are beyond the range of single precision.
  auto q = random_values(count * 3, 28);
  for (std::size_t p = 0; p < count; ++p) {
    q[3 * p] *= 1e-60;
    q[3 * p + 1] *= 1e60;
  }
  expect_equal(q, {-1, -1, 0}, bar);
}

TEST_P(FastParticleSplat, AParticleAtRestStaysAtRestAmongFastOnes) {
  // Channel 1 is w q with q = 0 for every other particle: no reference may leave a trace of itself where only those
  // are.
  auto q = random_values(count * 2, 29);
  for (std::size_t p = 0; p < count; ++p) {
    q[2 * p] = 2 + q[2 * p];
    q[2 * p + 1] = p % 2 == 0 ? 0 : q[2 * p] * (100 + q[2 * p + 1]);
  }
  expect_equal(q, {-1, 0}, bar);
}

TEST_P(FastParticleSplat, GivesTheSameBytesForAnyThreads) {
  const auto q = random_values(count * 5, 27);
  expect_same_bytes_for_any_threads([&] {
    return splat_particles_fast(lattice, kernel, buckets, topology, q, std::vector<int>{-1, 0, 0, 0, -1});
  });
}

INSTANTIATE_TEST_SUITE_P(Scenes, FastParticleSplat, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

}  // namespace
}  // namespace grainvdb::fast_particles_test
