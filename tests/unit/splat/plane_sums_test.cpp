#include "splat/plane_sums.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/moment.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::plane_sums_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

class PlaneSumsInDouble : public testing::TestWithParam<Scene> {
 protected:
  using Weight = std::function<double(std::size_t entry, double z)>;

  /// Compares a channel with Σ q weight(z), z from the start of each entry and all its images to the plane.
  void expect_sums(const PlaneSums& sums, int channel, int axis, const std::vector<double>& start, double longest,
                   const std::function<double(std::size_t)>& q, const Weight& weight) {
    const double reach = scene.cutoff + longest + scene.voxel;
    const std::vector<Coord> voxels = scene.voxels(reach);
    const Coord first = voxels.front();
    for (const Coord& v : voxels) {
      if ((axis != 0 && v.x != first.x) || (axis != 1 && v.y != first.y) || (axis != 2 && v.z != first.z)) continue;
      const std::int64_t row = std::int64_t{v[axis]} - sums.first;
      const bool inside = row >= 0 && row < static_cast<std::int64_t>(sums.planes());
      double sum = 0, terms = 0;
      for (std::size_t e = 0; e < start.size(); ++e) {
        const double length = scene.box.length(axis);
        const bool periodic = scene.box.periodic[static_cast<std::size_t>(axis)];
        double z = lattice.centre(axis, v[axis]) - start[e];
        const int images = periodic ? static_cast<int>(reach / length) + 1 : 0;
        if (periodic) z -= length * std::round(z / length);
        for (int k = -images; k <= images; ++k) {
          const double term = q(e) * weight(e, z + k * length);
          sum += term;
          terms += std::abs(term);
        }
      }
      // Places far outside the box are known to some ε of themselves: that is what they differ by, and the slopes of
      // weights are below 8/c².
      const double shift = position_error({start, start, start});
      const double slope = 8 / (scene.cutoff * scene.cutoff) * std::max(1.0, 1 / scene.cutoff) * largest(start, q);
      EXPECT_NEAR(inside ? sums.value(static_cast<std::size_t>(row), channel) : 0, sum,
                  50 * epsilon * terms + slope * shift)
          << "plane " << v[axis] << " of " << axis << ", channel " << channel;
    }
  }

  static double largest(const std::vector<double>& start, const std::function<double(std::size_t)>& q) {
    double sum = 0;
    for (std::size_t e = 0; e < start.size(); ++e) sum += std::abs(q(e));
    return sum;
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
};

TEST_P(PlaneSumsInDouble, OfPointsAndGradients) {
  for (int axis = 0; axis < 3; ++axis) {
    const Columns3 x = scene.random_positions(50, 41);
    const std::vector<double>& start = x[static_cast<std::size_t>(axis)];
    const auto q = random_values(start.size() * 2, 42);
    const PlaneSources points{lattice, kernel, axis, start};
    const PlaneSums sums = sum_on_planes(points, q, 2), slopes = sum_gradients_on_planes(points, q, 2);
    for (int c = 0; c < 2; ++c) {
      const auto value = [&](std::size_t e) { return q[2 * e + static_cast<std::size_t>(c)]; };
      expect_sums(sums, c, axis, start, 0, value, [&](std::size_t, double z) { return kernel.marginal(z); });
      // The curvature of w₁ is below 30/c³.
      expect_sums(
          slopes, c, axis, start, 0, [&](std::size_t e) { return 4 * value(e); },
          [&](std::size_t, double z) { return kernel.marginal_gradient(z) / 4; });
    }
  }
}

TEST_P(PlaneSumsInDouble, OfBranchesLongAndAlongThePlanes) {
  for (int axis = 0; axis < 3; ++axis) {
    const Columns3 x = scene.random_positions(60, 43);
    const std::vector<double>& start = x[static_cast<std::size_t>(axis)];
    std::vector<double> arm = random_values(start.size(), 44);
    for (std::size_t e = 0; e < arm.size(); ++e) arm[e] *= scene.cutoff * std::pow(10.0, -static_cast<double>(e % 12));
    arm[3] = 0;
    arm[4] = 3 * scene.cutoff;
    const auto q = random_values(start.size() * 9, 45);
    const PlaneSums sums = sum_branches_on_planes({lattice, kernel, axis, start, &arm}, q, 9);
    for (const int c : {0, 8})
      expect_sums(
          sums, c, axis, start, 3 * scene.cutoff, [&](std::size_t e) { return q[9 * e + static_cast<std::size_t>(c)]; },
          [&](std::size_t e, double z) { return kernel.marginal_line_integral(z, arm[e]); });
  }
}

TEST_P(PlaneSumsInDouble, OfSecondMoments) {
  using SM = SecondMoments;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const Columns3 x = scene.random_positions(40, 46);
    auto q = random_values(x[a].size() * 4, 47);
    for (std::size_t e = 0; e < x[a].size(); ++e) q[4 * e] = 1.5 + q[4 * e];
    const PlaneSums sums = sum_second_moments_on_planes({lattice, kernel, axis, x[a]}, q);
    const auto w = [&](std::size_t e) { return q[4 * e]; };
    const auto v = [&](std::size_t e, std::size_t i) { return q[4 * e + 1 + i] / q[4 * e]; };
    const auto expect = [&](std::size_t channel, const std::function<double(std::size_t)>& value, int power) {
      expect_sums(sums, static_cast<int>(channel), axis, x[a], 0, value,
                  [&](std::size_t, double z) { return std::pow(-z, power) * kernel.marginal(z); });
    };
    expect(SM::weight, w, 0);
    expect(SM::place + a, w, 1);
    expect(SM::place_square + SM::pair(a, a), w, 2);
    for (std::size_t i = 0; i < 3; ++i) {
      expect(
          SM::velocity + i, [&](std::size_t e) { return w(e) * v(e, i); }, 0);
      expect(
          SM::velocity_place + 3 * i + a, [&](std::size_t e) { return w(e) * v(e, i); }, 1);
      for (std::size_t j = i; j < 3; ++j)
        expect(
            SM::velocity_square + SM::pair(i, j), [&](std::size_t e) { return w(e) * v(e, i) * v(e, j); }, 0);
    }
  }
}

TEST_P(PlaneSumsInDouble, BytesDoNotDependOnThreads) {
  const Columns3 x = scene.random_positions(9000, 48);
  const auto q = random_values(x[2].size() * 3, 49), arm = random_values(x[2].size(), 50);
  std::vector<double> results[2];
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results[threads - 1] = sum_branches_on_planes({lattice, kernel, 2, x[2], &arm}, q, 3).values;
  }
  ASSERT_EQ(results[0].size(), results[1].size());
  EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(double)), 0);
}

TEST_P(PlaneSumsInDouble, ReachedPlanesAreThoseOfPositiveSums) {
  const Columns3 x = scene.random_positions(3, 51);
  const std::vector<double> arm{0.4 * scene.cutoff, 0, -1.7 * scene.cutoff};
  std::vector<double> start(x[1].begin(), x[1].begin() + 3), ones(3, 1.0);
  const PlaneSources branches{lattice, kernel, 1, start, &arm};
  const ReachedPlanes planes = reached_planes(branches);
  const PlaneSums sums = sum_branches_on_planes(branches, ones, 1);
  ASSERT_EQ(planes.reached.size(), sums.planes());
  EXPECT_EQ(planes.first, sums.first);
  for (std::size_t n = 0; n < sums.planes(); ++n) {
    EXPECT_TRUE(planes.reached[n] != 0 || sums.value(n, 0) == 0) << n;
    EXPECT_TRUE(planes.reached[n] == 0 || sums.value(n, 0) > 0) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlaneSumsInDouble, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

TEST(PlaneSumsEdges, NothingReachesNoPlane) {
  const std::vector<double> none;
  const Lattice lattice(1, {0, 0, 0});
  const LucyKernel kernel(3);
  EXPECT_EQ(sum_on_planes({lattice, kernel, 0, none}, {}, 1).planes(), 0U);
  EXPECT_TRUE(reached_planes({lattice, kernel, 0, none}).reached.empty());
}

TEST(PlaneSumsEdges, RefusesValuesOfAnotherSizeAndMissingArms) {
  const std::vector<double> two{1, 2}, q{1};
  const Lattice lattice(1, {0, 0, 0});
  const LucyKernel kernel(3);
  EXPECT_THROW(sum_on_planes({lattice, kernel, 0, two}, q, 1), std::invalid_argument);
  EXPECT_THROW(sum_branches_on_planes({lattice, kernel, 0, two}, two, 1), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::plane_sums_test
