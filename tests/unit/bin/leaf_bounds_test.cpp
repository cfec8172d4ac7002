#include "bin/leaf_bounds.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "bin/buckets.hpp"
#include "splat/splat.hpp"

namespace grainvdb::leaf_bounds_test {
namespace {

double active_leaves(const Lattice& lattice, const Columns3& x, double cutoff) {
  const auto topology = particle_topology(lattice, LucyKernel(cutoff), bin_points(lattice, x, cutoff));
  return static_cast<double>(topology->active_voxel_count()) / leaf_size;
}

TEST(LeastLeaves, OnePointFillsACubeWithinItsSupport) {
  const Lattice lattice(0.1, {0, 0, 0});
  const Columns3 x{{{1.23}, {-4.56}, {0.78}}};
  const double edge = 10 / std::sqrt(3.0);  // voxels
  EXPECT_NEAR(least_leaves(lattice, x, 1), edge * edge * edge / 512, 1e-12);
  EXPECT_LT(least_leaves(lattice, x, 1), active_leaves(lattice, x, 1));
}

TEST(LeastLeaves, CubesAreCountedOnceAndPeriodsAreFilled) {
  Lattice lattice(0.1, {0, 0, 0});
  lattice.set_periods({{0, 0, 0}, {2, 2, 2}, {true, true, true}});
  Columns3 x;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 20; ++k) {
        x[0].push_back(0.1 * i + 2 * (i % 3));  // images of the same places
        x[1].push_back(0.1 * j);
        x[2].push_back(0.1 * k - 4);
      }
  EXPECT_NEAR(least_leaves(lattice, x, 1), 20.0 * 20 * 20 / 512, 1e-9);
  EXPECT_DOUBLE_EQ(active_leaves(lattice, x, 1), 20.0 * 20 * 20 / 512);
}

TEST(LeastLeaves, NoPointsNeedNone) {
  EXPECT_EQ(least_leaves(Lattice(1, {0, 0, 0}), {}, 3), 0);
}

TEST(MostLeaves, IsNoLessThanThereAre) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const bool periodic : {false, true})
    for (const std::size_t points : {std::size_t{1}, std::size_t{10}, std::size_t{3000}}) {
      Lattice lattice(0.1, {0.03, 0, 0});
      if (periodic) lattice.set_periods({{-3, -3, -3}, {3, 3, 3}, {true, true, true}});
      Columns3 x;
      for (auto& column : x)
        for (std::size_t p = 0; p < points; ++p) column.push_back(3 * uniform(random));
      const auto topology = particle_topology(lattice, LucyKernel(0.7), bin_points(lattice, x, 0.7));
      EXPECT_GE(most_leaves(lattice, x, 0.7), static_cast<double>(topology->leaf_count())) << points;
      EXPECT_LE(least_leaves(lattice, x, 0.7), most_leaves(lattice, x, 0.7)) << points;
    }
}

TEST(MostLeaves, FarPointsAreBoundedByWhatSurroundsThem) {
  const Lattice lattice(0.1, {0, 0, 0});
  const Columns3 x{{{0, 1e5}, {0, 1e5}, {0, 1e5}}};
  EXPECT_LT(most_leaves(lattice, x, 0.4), 1000);
}

TEST(MostLeaves, NoPointsNeedNone) {
  EXPECT_EQ(most_leaves(Lattice(1, {0, 0, 0}), {}, 3), 0);
}

}  // namespace
}  // namespace grainvdb::leaf_bounds_test
