// The second moments of velocity and place against the brute force, also where the mean velocity is large.
#include "splat/second_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "bin/buckets.hpp"
#include "splat/splat.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::second_moments_test {
namespace {

using SM = SecondMoments;

/// What the sums of a leaf are held to, relative to the sum of |terms| about the leaf's middle and mean velocity.
constexpr double bar = 1e-5;

/// How many factors v and r the terms of a channel have.
std::pair<int, int> powers(std::size_t channel) {
  if (channel < SM::velocity) return {0, 0};
  if (channel < SM::place) return {1, 0};
  if (channel < SM::velocity_square) return {0, 1};
  if (channel < SM::velocity_place) return {2, 0};
  return channel < SM::place_square ? std::pair{1, 1} : std::pair{0, 2};
}

class SecondMomentSplat : public testing::TestWithParam<Scene> {
 protected:
  /// 60 particles, velocities within 1 of `mean` along each axis.
  void make(double mean) {
    x = scene.random_positions(60, 31);
    const std::size_t n = x[0].size();
    const auto weights = random_values(n, 32);
    const auto velocities = random_values(3 * n, 33);
    q.clear();
    for (std::size_t p = 0; p < n; ++p) {
      q.push_back(1.5 + weights[p]);
      for (std::size_t a = 0; a < 3; ++a) q.push_back(q[4 * p] * (mean + velocities[3 * p + a]));
    }
    buckets = bin_points(lattice, x, scene.cutoff);
    topology = particle_topology(lattice, kernel, buckets);
  }

  LeafBuffers sums() const {
    LeafBuffers result(topology, SM::channels);
    splat_second_moments(lattice, kernel, buckets, *topology, q, [&](std::size_t leaf, const double* values) {
      std::copy_n(values, SM::channels * leaf_size, result.block(leaf, 0));
    });
    return result;
  }

  /// The same at one voxel by their definition, velocities measured from `about`.
  std::array<double, SM::channels> expected(const Coord& voxel, const Vec3& about) const {
    std::array<double, SM::channels> sum{};
    for (std::size_t p = 0; p < x[0].size(); ++p) {
      const Vec3 r = scene.shortest(row(x, p), lattice.centre(voxel));
      const double w = q[4 * p] * lucy(norm(r), scene.cutoff);
      Vec3 v;
      for (std::size_t a = 0; a < 3; ++a) v[a] = q[4 * p + 1 + a] / q[4 * p] - about[a];
      sum[SM::weight] += w;
      for (std::size_t i = 0; i < 3; ++i) {
        sum[SM::velocity + i] += w * v[i];
        sum[SM::place + i] += w * r[i];
        for (std::size_t j = 0; j < 3; ++j) sum[SM::velocity_place + 3 * i + j] += w * v[i] * r[j];
        for (std::size_t j = i; j < 3; ++j) {
          sum[SM::velocity_square + SM::pair(i, j)] += w * v[i] * v[j];
          sum[SM::place_square + SM::pair(i, j)] += w * r[i] * r[j];
        }
      }
    }
    return sum;
  }

  /// No velocity differs from the mean around its leaf by more than 2, no place from the leaf's middle by more than
  /// `reach`. A sum of up to four such terms comes of moving the origins.
  double velocity_range() const { return 2; }
  double reach() const { return scene.cutoff + 3.5 * scene.voxel; }
  double bound(double weight, int velocities, int places) const {
    return 4 * bar * weight * std::pow(velocity_range(), velocities) * std::pow(reach(), places);
  }

  template <class F>
  void for_each_active(const F& f) const {
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      topology->mask(l).for_each([&](int offset) { f(l, offset, voxel_at(topology->origin(l), offset)); });
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  Columns3 x;
  std::vector<double> q;
  Buckets buckets;
  std::shared_ptr<const Topology> topology;
};

TEST_P(SecondMomentSplat, EqualTheBruteForce) {
  make(0);
  const LeafBuffers found = sums();
  for_each_active([&](std::size_t leaf, int offset, const Coord& voxel) {
    const auto sum = expected(voxel, {0, 0, 0});
    for (std::size_t c = 0; c < SM::channels; ++c) {
      const auto [velocities, places] = powers(c);
      EXPECT_NEAR(found.block(leaf, static_cast<int>(c))[offset], sum[c], bound(sum[SM::weight], velocities, places))
          << "channel " << c;
    }
  });
}

// Sums of squares are 1e8, what is looked for is 1: single precision has 6 of 1e8 at best. Double precision has 1e-16
// of 1e8, three times.
TEST_P(SecondMomentSplat, CentralMomentsLoseNothingOnALargeMean) {
  constexpr double mean = 1e4;
  make(mean);
  const LeafBuffers found = sums();
  for_each_active([&](std::size_t leaf, int offset, const Coord& voxel) {
    const auto at = [&](std::size_t c) { return found.block(leaf, static_cast<int>(c))[offset]; };
    const auto sum = expected(voxel, {mean, mean, mean});
    const double w = at(SM::weight);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double central =
            at(SM::velocity_square + SM::pair(i, j)) - at(SM::velocity + i) * at(SM::velocity + j) / w;
        const double square =
            sum[SM::velocity_square + SM::pair(i, j)] - sum[SM::velocity + i] * sum[SM::velocity + j] / sum[SM::weight];
        EXPECT_NEAR(central, square, bound(w, 2, 0) + 3 * 0x1p-52 * mean * mean * w);
        const double sheared = at(SM::velocity_place + 3 * i + j) - at(SM::velocity + i) * at(SM::place + j) / w;
        const double slope =
            sum[SM::velocity_place + 3 * i + j] - sum[SM::velocity + i] * sum[SM::place + j] / sum[SM::weight];
        EXPECT_NEAR(sheared, slope, bound(w, 1, 1) + 3 * 0x1p-52 * mean * reach() * w);
      }
  });
}

TEST_P(SecondMomentSplat, GiveTheSameBytesForAnyThreads) {
  make(3);
  expect_same_bytes_for_any_threads([&] { return sums(); });
  expect_zero_where_inactive(sums());
}

INSTANTIATE_TEST_SUITE_P(Scenes, SecondMomentSplat, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

}  // namespace
}  // namespace grainvdb::second_moments_test
