#include "splat/profile.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include "unit/splat/scene.hpp"

namespace grainvdb::profile_test {
namespace {

// The bar of the project, relative to the sum of |terms|.
constexpr double bar = 1e-5;

class PlaneSplat : public testing::TestWithParam<Scene> {
 protected:
  /// Compares with Σ q w₁ over all images, written out.
  void expect_equal(int axis, std::size_t points, int channels) {
    const Columns3 x = scene.random_positions(points, 31);
    const std::size_t count = x[0].size();
    const auto q = random_values(count * static_cast<std::size_t>(channels), 32);
    const auto a = static_cast<std::size_t>(axis);
    const PlaneSums sums = splat_planes(lattice, kernel, axis, x[a], q, channels);
    const double shift = position_error(x);
    const double slope = 4 * 21 / (16 * scene.cutoff * scene.cutoff);  // above the largest |dw₁/dz|
    const int reach = static_cast<int>(std::ceil(scene.cutoff / scene.voxel)) + 2;
    int reached = 0;
    for (const Coord& v : scene.voxels(scene.cutoff + 2 * scene.voxel)) {
      const Coord first = scene.voxels(scene.cutoff + 2 * scene.voxel).front();
      if ((axis != 0 && v.x != first.x) || (axis != 1 && v.y != first.y) || (axis != 2 && v.z != first.z)) continue;
      const std::int64_t plane = std::int64_t{v[axis]} - sums.first;
      const bool inside = plane >= 0 && plane < static_cast<std::int64_t>(sums.planes());
      reached += inside ? 1 : 0;
      for (int c = 0; c < channels; ++c) {
        double sum = 0, terms = 0, near = 0;
        for (std::size_t p = 0; p < count; ++p) {
          const double value = q[p * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)];
          const double length = scene.box.length(axis);
          double z = lattice.centre(axis, v[axis]) - x[a][p];
          const int images = scene.box.periodic[a] ? static_cast<int>(scene.cutoff / length) + 1 : 0;
          if (images > 0) z -= length * std::round(z / length);
          for (int k = -images; k <= images; ++k) {
            const double w = kernel.marginal(z + k * length);
            sum += value * w;
            terms += std::abs(value) * w;
            near += std::abs(z + k * length) < scene.cutoff + shift ? std::abs(value) : 0;
          }
        }
        const double found = inside ? sums.value(static_cast<std::size_t>(plane), c) : 0;
        ASSERT_NEAR(found, sum, bar * terms + near * slope * shift)
            << "plane " << v[axis] << " of " << axis << ", channel " << c << ", reach " << reach;
      }
    }
    EXPECT_EQ(static_cast<std::size_t>(reached), sums.planes());
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
};

TEST_P(PlaneSplat, EqualsTheSumsInDoubleAlongEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) expect_equal(axis, 60, 3);
}

TEST_P(PlaneSplat, WithFewAndManyParticlesAndAnyNumberOfChannels) {
  for (const std::size_t points : {std::size_t{1}, std::size_t{2}, std::size_t{2000}}) expect_equal(2, points, 2);
  for (const int channels : {1, 5, 14, 25}) expect_equal(1, 30, channels);
}

TEST_P(PlaneSplat, EveryInstructionSetGivesTheSame) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    expect_equal(0, 40, 5);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST_P(PlaneSplat, BytesDoNotDependOnThreads) {
  const Columns3 x = scene.random_positions(3000, 33);
  const auto q = random_values(x[0].size() * 4, 34);
  std::vector<double> results[2];
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results[threads - 1] = splat_planes(lattice, kernel, 2, x[2], q, 4).values;
  }
  ASSERT_EQ(results[0].size(), results[1].size());
  EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(double)), 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlaneSplat, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

TEST(PlaneSplatEdges, NoParticlesReachNoPlane) {
  EXPECT_EQ(splat_planes(Lattice(1, {0, 0, 0}), LucyKernel(3), 0, {}, {}, 1).planes(), 0U);
}

TEST(PlaneSplatEdges, RefusesValuesOfAnotherSize) {
  const double q = 1;
  EXPECT_THROW(splat_planes(Lattice(1, {0, 0, 0}), LucyKernel(3), 0, {1, 2}, {&q, 1}, 1), std::invalid_argument);
}

TEST(PlaneSplatEdges, IsWhatTheSplatSumsToOverPlanes) {
  // h Σ over planes of one particle is its q: the marginal is smooth enough for the midpoint rule at c/h = 6.
  const double q = 2;
  const PlaneSums sums = splat_planes(Lattice(0.5, {0, 0, 0}), LucyKernel(3), 2, {0.2}, {&q, 1}, 1);
  double total = 0;
  for (std::size_t p = 0; p < sums.planes(); ++p) total += 0.5 * sums.value(p, 0);
  EXPECT_NEAR(total, q, 2.4e-5 * q);  // as for the whole kernel
}

}  // namespace
}  // namespace grainvdb::profile_test
