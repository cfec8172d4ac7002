#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bin/buckets.hpp"
#include "splat/splat.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::particles_test {
namespace {

class ParticleSplat : public testing::TestWithParam<Scene> {
 protected:
  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  Columns3 x = scene.random_positions(60, 11);
  Buckets buckets = bin_points(lattice, x, scene.cutoff);
  std::shared_ptr<const Topology> topology = particle_topology(lattice, kernel, buckets);
  std::size_t count = x[0].size();
};

TEST_P(ParticleSplat, TopologyIsWhereTheKernelIsPositive) {
  std::size_t active = 0;
  for (const Coord& voxel : scene.voxels(scene.cutoff + 2 * scene.voxel)) {
    bool inside = false, at_rim = false;
    for (std::size_t p = 0; p < count; ++p) {
      const double r = norm(scene.shortest(lattice.centre(voxel), row(x, p)));
      inside = inside || r < scene.cutoff;
      at_rim = at_rim || std::abs(r - scene.cutoff) <= 1e-12 * scene.cutoff;
    }
    const bool found = is_active(*topology, voxel);
    active += found ? 1U : 0U;
    EXPECT_TRUE(at_rim || found == inside) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
  }
  EXPECT_EQ(topology->active_voxel_count(), active) << "a voxel outside the stored period";
  EXPECT_GT(active, 0u);
}

TEST_P(ParticleSplat, SumsEqualTheBruteForce) {
  const int channels = 3;
  const auto q = random_values(count * channels, 12);
  const LeafBuffers sums = splat_particles(lattice, kernel, buckets, topology, q, channels);
  const double shift = position_error(x);
  for (const Coord& voxel : scene.voxels(scene.cutoff + 2 * scene.voxel))
    for (int c = 0; c < channels; ++c) {
      double sum = 0, terms = 0, reached = 0;
      for (std::size_t p = 0; p < count; ++p) {
        const double r = norm(scene.shortest(lattice.centre(voxel), row(x, p)));
        const double value = q[p * channels + static_cast<std::size_t>(c)];
        sum += value * lucy(r, scene.cutoff);
        terms += std::abs(value) * lucy(r, scene.cutoff);
        if (r < scene.cutoff) reached += std::abs(value);
      }
      // Rounding of the sum, and of the positions where the kernel is steep.
      const double tolerance = 1e-13 * terms + reached * largest_gradient(scene.cutoff) * shift;
      ASSERT_LE(tolerance, 1e-12 * reached * lucy_peak(scene.cutoff));
      EXPECT_NEAR(value_at(sums, voxel, c), sum, tolerance);
    }
  expect_zero_where_inactive(sums);
}

TEST_P(ParticleSplat, SquaresEqualTheBruteForce) {
  const auto q = random_values(count, 17);
  const LeafBuffers sums = splat_particle_squares(lattice, kernel, buckets, topology, q, 1);
  const double c = scene.cutoff;
  const double shift = position_error(x) * 2 * lucy_peak(c) * largest_gradient(c);  // d(W²) ≤ 2 W(0) |∇W| dr
  for (const Coord& voxel : scene.voxels(c + 2 * scene.voxel)) {
    double sum = 0, terms = 0, reached = 0;
    for (std::size_t p = 0; p < count; ++p) {
      const double r = norm(scene.shortest(lattice.centre(voxel), row(x, p)));
      if (r >= c) continue;
      const double term = q[p] * lucy(r, c) * lucy(r, c);
      sum += term;
      terms += std::abs(term);
      reached += std::abs(q[p]);
    }
    EXPECT_NEAR(value_at(sums, voxel, 0), sum, 1e-13 * terms + reached * shift);
  }
  expect_zero_where_inactive(sums);
}

TEST_P(ParticleSplat, GradientsEqualTheBruteForce) {
  const int values = 2;
  const auto q = random_values(count * values, 13);
  const LeafBuffers sums = splat_particle_gradients(lattice, kernel, buckets, topology, q, values);
  ASSERT_EQ(sums.channels(), 6);
  const double c = scene.cutoff;
  const double shift = position_error(x);
  for (const Coord& voxel : scene.voxels(c + 2 * scene.voxel))
    for (int v = 0; v < values; ++v)
      for (int j = 0; j < 3; ++j) {
        double sum = 0, terms = 0, reached = 0;
        for (std::size_t p = 0; p < count; ++p) {
          const Vec3 d = scene.shortest(lattice.centre(voxel), row(x, p));
          const double r = norm(d);
          if (r >= c) continue;
          const double value = q[p * values + static_cast<std::size_t>(v)];
          const double term =
              -value * largest_curvature(c) * (1 - r / c) * (1 - r / c) * d[static_cast<std::size_t>(j)];
          sum += term;
          terms += std::abs(term);
          reached += std::abs(value);
        }
        const double tolerance = 1e-13 * terms + reached * largest_curvature(c) * shift;
        EXPECT_NEAR(value_at(sums, voxel, 3 * v + j), sum, tolerance);
      }
  expect_zero_where_inactive(sums);
}

TEST_P(ParticleSplat, BytesDoNotDependOnThreads) {
  const Columns3 many = scene.random_positions(1500, 14);
  const auto q = random_values(many[0].size() * 2, 15);
  expect_same_bytes_for_any_threads([&] {
    const Buckets b = bin_points(lattice, many, scene.cutoff);
    return splat_particles(lattice, kernel, b, particle_topology(lattice, kernel, b), q, 2);
  });
  expect_same_bytes_for_any_threads([&] {
    const Buckets b = bin_points(lattice, many, scene.cutoff);
    return splat_particle_gradients(lattice, kernel, b, particle_topology(lattice, kernel, b), q, 2);
  });
}

TEST_P(ParticleSplat, ChannelsDoNotDisturbEachOther) {
  const auto q = random_values(count * 5, 16);
  const LeafBuffers all = splat_particles(lattice, kernel, buckets, topology, q, 5);
  for (std::size_t c = 0; c < 5; ++c) {
    std::vector<double> one;
    for (std::size_t p = 0; p < count; ++p) one.push_back(q[5 * p + c]);
    const LeafBuffers alone = splat_particles(lattice, kernel, buckets, topology, one, 1);
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      EXPECT_EQ(std::memcmp(all.block(l, static_cast<int>(c)), alone.block(l, 0), leaf_size * sizeof(double)), 0);
  }
}

TEST_P(ParticleSplat, TopologyMayHoldMoreOrLessThanTheReachedVoxels) {
  const std::vector<double> q(count, 1.0);
  const LeafBuffers full = splat_particles(lattice, kernel, buckets, topology, q, 1);
  // One leaf of the topology, all of its voxels in the period or not, and one leaf far away.
  LeafMask every;
  for (int o = 0; o < leaf_size; ++o) every.set(o);
  const Coord known = topology->origin(topology->leaf_count() / 2);
  const auto other = std::make_shared<const Topology>(
      std::vector<Coord>{known, {80000, 0, 0}}, std::vector<LeafMask>{topology->mask(*topology->find(known)), every});
  const LeafBuffers sums = splat_particles(lattice, kernel, buckets, other, q, 1);
  EXPECT_EQ(std::memcmp(sums.block(0, 0), full.block(topology->leaf_count() / 2, 0), leaf_size * sizeof(double)), 0);
  for (int o = 0; o < leaf_size; ++o) EXPECT_EQ(sums.block(1, 0)[o], 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ParticleSplat, testing::ValuesIn(scenes()),
                         [](const auto& each) { return each.param.name; });

// h³ ΣW over the voxels against ∫W dV = 1: the worst offset of the particle, as tabulated for the kernel.
TEST(ParticleSplatSum, ConservesVolumeToTheTabulatedError) {
  const double table[][2] = {{3, 2.25e-3}, {4, 3.35e-4}, {6, 2.45e-5}};
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (const auto& [cells, bound] : table) {
    const Lattice lattice(1 / cells, {0.01, 0.02, 0.03});
    const LucyKernel kernel(1);
    double worst = 0;
    for (int k = 0; k < 400; ++k) {
      // Random offsets, and the corner, face and centre of a voxel.
      Vec3 x{uniform(random) + 0.01, uniform(random) + 0.02, uniform(random) + 0.03};
      if (k < 8) x = {0.01 + 0.5 * (k & 1) / cells, 0.02 + 0.25 * (k & 2) / cells, 0.03 + 0.125 * (k & 4) / cells};
      const Buckets b = bin_points(lattice, {{{x[0]}, {x[1]}, {x[2]}}}, 1);
      const double one = 1;
      const LeafBuffers w = splat_particles(lattice, kernel, b, particle_topology(lattice, kernel, b), {&one, 1}, 1);
      double sum = 0;
      for (std::size_t l = 0; l < w.topology()->leaf_count(); ++l)
        for (int o = 0; o < leaf_size; ++o) sum += w.block(l, 0)[o];
      worst = std::max(worst, std::abs(sum / (cells * cells * cells) - 1));
    }
    EXPECT_LE(worst, bound) << cells;
    EXPECT_GE(worst, 0.5 * bound) << cells;
  }
}

TEST(ParticleSplatSum, ConservesVolumeAcrossPeriodicBoundaries) {
  // 7.5 = 45 voxels of 1/6; every particle counts once however many images it has.
  const Scene scene{"box", {{-1, 0, 2}, {6.5, 7.5, 9.5}, {true, true, true}}, 1.0 / 6, {0.03, 0, 0}, 1};
  const Lattice lattice = scene.lattice();
  const Columns3 x = scene.random_positions(200, 18);
  std::vector<double> volume;
  double total = 0;
  for (const double q : random_values(200, 19)) total += volume.emplace_back(1.5 + q);
  const LucyKernel kernel(scene.cutoff);
  const Buckets b = bin_points(lattice, x, scene.cutoff);
  const LeafBuffers phi = splat_particles(lattice, kernel, b, particle_topology(lattice, kernel, b), volume, 1);
  double sum = 0;
  for (const Coord& voxel : scene.voxels(0)) sum += value_at(phi, voxel, 0);
  EXPECT_NEAR(sum / 216 / total, 1, 2.4e-5);
}

TEST(ParticleSplatSum, ParticleOnAVoxelCentreGivesThePeakThere) {
  const Lattice lattice(0.25, {0, 0, 0});
  const LucyKernel kernel(0.25);  // the neighbours lie exactly on the rim, where W = 0
  const Buckets b = bin_points(lattice, {{{-0.125}, {0.125}, {2.125}}}, 0.25);
  const auto topology = particle_topology(lattice, kernel, b);
  EXPECT_EQ(topology->active_voxel_count(), 1u);
  const double q = 2;
  const LeafBuffers sum = splat_particles(lattice, kernel, b, topology, {&q, 1}, 1);
  EXPECT_DOUBLE_EQ(value_at(sum, {-1, 0, 8}, 0), 2 * lucy_peak(0.25));
  const LeafBuffers gradient = splat_particle_gradients(lattice, kernel, b, topology, {&q, 1}, 1);
  for (int j = 0; j < 3; ++j) EXPECT_EQ(value_at(gradient, {-1, 0, 8}, j), 0);
}

TEST(ParticleSplatSum, NoParticlesGiveNoVoxels) {
  const Lattice lattice(1, {0, 0, 0});
  const LucyKernel kernel(3);
  const Buckets b = bin_points(lattice, {}, 3);
  const auto topology = particle_topology(lattice, kernel, b);
  EXPECT_EQ(topology->leaf_count(), 0u);
  EXPECT_EQ(splat_particles(lattice, kernel, b, topology, {}, 4).bytes(), 0u);
}

TEST(ParticleSplatSum, ParticleBetweenVoxelsBeyondItsReachGivesNoVoxels) {
  const Lattice lattice(1, {0, 0, 0});
  const LucyKernel kernel(0.3);
  const Buckets b = bin_points(lattice, {{{1}, {1}, {1}}}, 0.3);
  EXPECT_EQ(particle_topology(lattice, kernel, b)->leaf_count(), 0u);
}

}  // namespace
}  // namespace grainvdb::particles_test
