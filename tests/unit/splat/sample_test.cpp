#include "splat/sample.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bin/buckets.hpp"
#include "splat/splat.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::sample_test {
namespace {

// Leaf buffers with the given channels at the given voxels.
LeafBuffers buffers_of(const std::vector<Coord>& voxels, int channels,
                       const std::function<double(const Coord&, int)>& value) {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (const Coord& v : voxels) {
    origins.push_back(leaf_origin(v));
    masks.emplace_back().set(leaf_offset(v));
  }
  LeafBuffers b(std::make_shared<const Topology>(origins, masks), channels);
  for (const Coord& v : voxels)
    for (int c = 0; c < channels; ++c) b.block(*b.topology()->find(leaf_origin(v)), c)[leaf_offset(v)] = value(v, c);
  return b;
}

// A number from 0.1 to 0.9 that belongs to a voxel and a channel.
double noise(const Coord& v, int channel) {
  std::uint64_t hash = 0;
  for (const int key : {v.x, v.y, v.z, channel})
    hash = (hash ^ static_cast<std::uint32_t>(key)) * 0x9e3779b97f4a7c15U, hash ^= hash >> 29;
  return 0.1 + 0.8 * static_cast<double>(hash >> 11) / 9007199254740992.0;  // 2⁵³
}

double value_in(const LeafBlocks& blocks, const Coord& c, int channel) {
  const auto leaf = blocks.topology->find(leaf_origin(c));
  return leaf ? blocks.block(*leaf, channel)[leaf_offset(c)] : 0;
}

// The interpolation written out with a dense map of the sums over the homogeneous axes.
class DenseSample {
 public:
  DenseSample(const Scene& scene, const RatioView& ratio, std::array<bool, 3> homogeneous)
      : lattice_(scene.lattice()), homogeneous_(homogeneous) {
    for (const Coord& v : scene.voxels(0)) {
      auto& s = sums_[{homogeneous[0] ? 0 : v.x, homogeneous[1] ? 0 : v.y, homogeneous[2] ? 0 : v.z}];
      for (std::size_t a = 0; a < 3; ++a) s[a] += value_in(ratio.numerator, v, ratio.first + static_cast<int>(a));
      s[3] += value_in(ratio.denominator, v, ratio.channel);
    }
  }

  Vec3 at(const Vec3& x) const {
    // Weights of the voxels next to x along each axis.
    std::array<std::map<std::int32_t, double>, 3> weights;
    for (int a = 0; a < 3; ++a) {
      auto& w = weights[static_cast<std::size_t>(a)];
      if (homogeneous_[static_cast<std::size_t>(a)]) {
        w[0] = 1;
        continue;
      }
      const double u = lattice_.to_index(a, x[static_cast<std::size_t>(a)]);
      const auto below = static_cast<std::int32_t>(std::floor(u));
      w[lattice_.wrap(a, below)] += below + 1 - u;
      w[lattice_.wrap(a, below + 1)] += u - below;
    }
    Vec3 result{};
    for (const auto& [i, wi] : weights[0])
      for (const auto& [j, wj] : weights[1])
        for (const auto& [k, wk] : weights[2]) {
          const auto& s = sums_.at({i, j, k});
          for (std::size_t a = 0; a < 3; ++a) result[a] += wi * wj * wk * s[a] / s[3];
        }
    return result;
  }

 private:
  Lattice lattice_;
  std::array<bool, 3> homogeneous_;
  std::map<Coord, std::array<double, 4>> sums_;
};

class Sample : public testing::TestWithParam<Scene> {
 protected:
  // Positions at which all eight voxels lie among those of the scene.
  Columns3 inner_positions() const {
    Columns3 x = scene.random_positions(80, 31);
    for (std::size_t a = 0; a < 3; ++a)
      for (double& value : x[a])
        if (!scene.box.periodic[a])
          value = std::clamp(value, scene.box.lo[a] + scene.voxel, scene.box.hi[a] - scene.voxel);
    return x;
  }
  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LeafBuffers numerator = buffers_of(scene.voxels(0), 5, noise);
  LeafBuffers denominator = buffers_of(scene.voxels(0), 2, [](const Coord& v, int c) { return noise(v, 10 + c); });
  RatioView ratio{numerator.blocks(), 2, denominator.blocks(), 1};
};

TEST_P(Sample, TrilinearEqualsTheBruteForce) {
  const Columns3 x = inner_positions();
  const auto samples = sample_trilinear(lattice, ratio, x);
  const DenseSample dense(scene, ratio, {false, false, false});
  for (std::size_t p = 0; p < samples.size(); ++p) {
    const Vec3 expected = dense.at(row(x, p));
    // Ratios are at most 9; a shift δ of the position changes the sample by less than 3 · 9 δ/h.
    const double tolerance = 27 * position_error(x) / scene.voxel;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(samples[p][a], expected[a], tolerance);
  }
}

TEST_P(Sample, ProfilesEqualTheBruteForce) {
  const Columns3 x = inner_positions();
  for (unsigned bits = 0; bits < 8; ++bits) {
    const std::array<bool, 3> homogeneous{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
    const auto samples = sample_profile(lattice, ratio, x, homogeneous);
    const DenseSample dense(scene, ratio, homogeneous);
    for (std::size_t p = 0; p < samples.size(); ++p) {
      const Vec3 expected = dense.at(row(x, p));
      const double tolerance = 27 * position_error(x) / scene.voxel + 1e-13;
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(samples[p][a], expected[a], tolerance) << bits;
    }
  }
}

TEST_P(Sample, SplattedUniformVelocityComesBackAtEveryParticle) {
  const Vec3 u{1.25, -300, 4e-3};
  const Columns3 x = scene.random_positions(100, 32);
  std::vector<double> q;
  for (const double v : random_values(100, 33))
    for (const double factor : {1.0, u[0], u[1], u[2]}) q.push_back((v + 2) * factor);
  const LucyKernel kernel(scene.cutoff);
  const Buckets b = bin_points(lattice, x, scene.cutoff);
  const LeafBuffers sums = splat_particles(lattice, kernel, b, particle_topology(lattice, kernel, b), q, 4);
  const RatioView velocity{sums.blocks(), 1, sums.blocks(), 0};
  for (const Vec3& sample : sample_trilinear(lattice, velocity, x))
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(sample[a], u[a], 1e-13 * std::abs(u[a]));
  for (const auto& homogeneous : {std::array{true, true, false}, std::array{true, true, true}})
    for (const Vec3& sample : sample_profile(lattice, velocity, x, homogeneous))
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(sample[a], u[a], 1e-13 * std::abs(u[a]));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Sample, testing::ValuesIn(scenes()), [](const auto& each) { return each.param.name; });

TEST(SampleLinear, LinearFieldsAreReproduced) {
  const Scene& scene = scenes()[3];  // open
  const Lattice lattice = scene.lattice();
  const auto weight = [](const Coord& v) { return noise(v, 0); };
  const auto linear = [](const Vec3& x, int c) { return 1 + c + 2 * x[0] - 3 * x[1] + 0.5 * (c + 1) * x[2]; };
  const LeafBuffers b = buffers_of(scene.voxels(1), 4, [&](const Coord& v, int c) {
    return c == 3 ? weight(v) : weight(v) * linear(lattice.centre(v), c);
  });
  const Columns3 x = scene.random_positions(200, 34);
  const auto samples = sample_trilinear(lattice, {b.blocks(), 0, b.blocks(), 3}, x);
  for (std::size_t p = 0; p < samples.size(); ++p)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(samples[p][static_cast<std::size_t>(c)], linear(row(x, p), c), 1e-12);
}

TEST(SampleLinear, ProfileOfAFieldThatIsLinearInOneDirection) {
  const Scene& scene = scenes()[2];  // periodic in x and y
  const Lattice lattice = scene.lattice();
  const LeafBuffers b = buffers_of(scene.voxels(1), 4, [&](const Coord& v, int c) {
    return noise(v, 0) * (c == 3 ? 1 : 2 - 0.7 * (c + 1) * lattice.centre(2, v.z));
  });
  const Columns3 x = scene.random_positions(200, 35);
  const auto samples = sample_profile(lattice, {b.blocks(), 0, b.blocks(), 3}, x, {true, true, false});
  for (std::size_t p = 0; p < samples.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(samples[p][c], 2 - 0.7 * (static_cast<double>(c) + 1) * x[2][p], 1e-12);
}

TEST(SampleEdges, OnAVoxelCentreOnlyThatVoxelIsNeeded) {
  const Lattice lattice(0.5, {0, 0, 0});
  const LeafBuffers b = buffers_of({{-1, 2, 3}}, 4, [](const Coord&, int c) { return c + 1.0; });
  const auto samples = sample_trilinear(lattice, {b.blocks(), 1, b.blocks(), 0}, {{{-0.25}, {1.25}, {1.75}}});
  EXPECT_EQ(samples[0], (Vec3{2, 3, 4}));
}

TEST(SampleEdges, NumeratorMayCoverLessThanTheDenominator) {
  const Lattice lattice(1, {0, 0, 0});
  const LeafBuffers upper = buffers_of({{0, 0, 0}}, 3, [](const Coord&, int) { return 4.0; });
  const LeafBuffers lower = buffers_of({{0, 0, 0}, {-1, 0, 0}}, 1, [](const Coord&, int) { return 2.0; });
  const auto samples = sample_trilinear(lattice, {upper.blocks(), 0, lower.blocks(), 0}, {{{0.25}, {0.5}, {0.5}}});
  EXPECT_EQ(samples[0], (Vec3{1.5, 1.5, 1.5}));  // ¾ of 4/2, ¼ of 0/2
  const auto profile =
      sample_profile(lattice, {upper.blocks(), 0, lower.blocks(), 0}, {{{9}, {0.5}, {0.5}}}, {true, false, false});
  EXPECT_EQ(profile[0], (Vec3{1, 1, 1}));
}

TEST(SampleEdges, NumeratorMayCoverMoreThanTheDenominator) {
  const Lattice lattice(1, {0, 0, 0});
  const LeafBuffers upper = buffers_of({{0, 0, 0}, {0, 0, 9}}, 3, [](const Coord&, int) { return 4.0; });
  const LeafBuffers lower = buffers_of({{0, 0, 0}}, 1, [](const Coord&, int) { return 2.0; });
  const auto profile =
      sample_profile(lattice, {upper.blocks(), 0, lower.blocks(), 0}, {{{0.5}, {0.5}, {0.5}}}, {true, true, false});
  EXPECT_EQ(profile[0], (Vec3{2, 2, 2}));
}

TEST(SampleEdges, RefusesPositionsBesideUnreachedVoxels) {
  const Lattice lattice(1, {0, 0, 0});
  const LeafBuffers b = buffers_of({{0, 0, 0}}, 4, [](const Coord&, int) { return 1.0; });
  const RatioView ratio{b.blocks(), 1, b.blocks(), 0};
  const Columns3 beside{{{0.75}, {0.5}, {0.5}}};
  EXPECT_THROW(sample_trilinear(lattice, ratio, beside), std::logic_error);
  EXPECT_THROW(sample_profile(lattice, ratio, beside, {false, true, true}), std::logic_error);
  EXPECT_NO_THROW(sample_profile(lattice, ratio, beside, {true, true, true}));
  const LeafBuffers empty(std::make_shared<const Topology>(), 4);
  EXPECT_THROW(sample_profile(lattice, {empty.blocks(), 1, empty.blocks(), 0}, beside, {true, true, true}),
               std::logic_error);
}

TEST(SampleEdges, RefusesPositionsThatAreNotFinite) {
  const Lattice lattice(1, {0, 0, 0});
  const LeafBuffers b = buffers_of({{0, 0, 0}}, 4, [](const Coord&, int) { return 1.0; });
  for (double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e18})
    EXPECT_THROW(sample_trilinear(lattice, {b.blocks(), 1, b.blocks(), 0}, {{{x}, {0.5}, {0.5}}}),
                 std::invalid_argument);
}

TEST(SampleEdges, NoPositionsGiveNoSamples) {
  const LeafBuffers b(std::make_shared<const Topology>(), 4);
  EXPECT_TRUE(sample_trilinear(Lattice(1, {0, 0, 0}), {b.blocks(), 1, b.blocks(), 0}, {}).empty());
}

}  // namespace
}  // namespace grainvdb::sample_test
