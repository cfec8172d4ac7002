// The vectorised sums over contacts against sums in double of the same rules, and against the closed form.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "grainvdb/line_rule.hpp"
#include "splat/bricks.hpp"
#include "splat/splat.hpp"
#include "unit/splat/branch_scene.hpp"

namespace grainvdb::fast_contacts_test {
namespace {

// The bar of the project, rims included: a voxel that only the rim of one support reaches must be right too.
constexpr double bar = 1e-5;

class FastContactSplat : public testing::TestWithParam<Scene> {
 protected:
  double mean(LineIntegral method, const Vec3& p, const Vec3& a) const {
    if (method == LineIntegral::midpoint_curvature()) return divided(p, a);
    return method.method == LineIntegral::Method::adaptive ? kernel.line_integral_adaptive(p, a)
                                                           : kernel.line_integral_gauss(p, a, method.gauss_points);
  }
  double divided(const Vec3& p, const Vec3& a) const {
    const int parts = curved_branch_parts(norm(a) / scene.cutoff);
    const Vec3 part{a[0] / parts, a[1] / parts, a[2] / parts};
    double sum = 0;
    for (int k = 0; k < parts; ++k)
      sum +=
          kernel.line_integral_midpoint_curvature({p[0] + k * part[0], p[1] + k * part[1], p[2] + k * part[2]}, part);
    return sum / parts;
  }
  std::vector<ReachedVoxel> weigh(LineIntegral method) const {
    return weigh_branches(scene, branches, [&](const Vec3& p, const Vec3& a) { return mean(method, p, a); });
  }

  /// Compares every voxel with the sums in double of the same rule, relative to the sum of |terms|; and the topology
  /// with the voxels within a cutoff of a branch.
  void expect_equal(const std::vector<double>& q, int channels, LineIntegral method,
                    const std::vector<ReachedVoxel>& expected) const {
    const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, channels, method);
    // Rounding may move a voxel against a branch; for terms at the rim that is all there is.
    const double shift = position_error(branches.start) * largest_gradient(scene.cutoff);
    std::size_t active = 0;
    for (const ReachedVoxel& v : expected) {
      ASSERT_EQ(is_active(*sums.topology(), v.voxel), !v.branches.empty());
      active += v.branches.empty() ? 0U : 1U;
      for (int c = 0; c < channels; ++c) {
        double sum = 0, terms = 0, reached = 0;
        for (const auto& [b, w] : v.branches) {
          const double value = q[b * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)];
          sum += value * w;
          terms += std::abs(value * w);
          reached += std::abs(value);
        }
        EXPECT_NEAR(value_at(sums, v.voxel, c), sum, bar * terms + shift * reached)
            << "channel " << c << " of " << channels << ", gauss points " << method.gauss_points << ", "
            << splat_target();
      }
    }
    EXPECT_EQ(sums.topology()->active_voxel_count(), active) << "a voxel outside the stored period";
    expect_zero_where_inactive(sums);
  }
  void expect_equal(std::size_t channels, LineIntegral method) const {
    expect_equal(random_values(branches.size() * channels, 22), static_cast<int>(channels), method, weigh(method));
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  HalfBranches branches = random_branches(scene, 30, 21);
};

TEST_P(FastContactSplat, EqualsTheSumsInDoubleForAnyNumberOfChannels) {
  const auto expected = weigh(LineIntegral::adaptive());
  for (const std::size_t channels : {1U, 2U, 9U, 14U, 15U, 16U, 24U, 25U, 40U})
    expect_equal(random_values(branches.size() * channels, 22), static_cast<int>(channels), LineIntegral::adaptive(),
                 expected);
}

TEST_P(FastContactSplat, EqualsTheSumsInDoubleForEveryRule) {
  for (int n = 1; n <= 8; ++n) expect_equal(2, LineIntegral::gauss(n));
  expect_equal(2, LineIntegral::midpoint_curvature());
}

TEST_P(FastContactSplat, EqualsTheSumsInDoubleWithFewAndManyBranches) {
  for (const std::size_t n : {1U, 2U, 17U, 200U}) {
    branches = random_branches(scene, n, 31);
    for (const LineIntegral method : {LineIntegral::adaptive(), LineIntegral::gauss(3)}) expect_equal(3, method);
  }
}

TEST_P(FastContactSplat, EveryInstructionSetGivesTheSame) {
  branches = random_branches(scene, 40, 32, 0, 0.7);
  const auto q = random_values(branches.size() * 9, 24);
  for (const LineIntegral method :
       {LineIntegral::adaptive(), LineIntegral::gauss(4), LineIntegral::midpoint_curvature()}) {
    const auto expected = weigh(method);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      expect_equal(q, 9, method, expected);
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST_P(FastContactSplat, ErrsByNoMoreThanItsBoundOnBranchesOfAllLengths) {
  // Every rule, and branches that are divided: up to one and a half cutoffs.
  branches = random_branches(scene, 40, 33, 0, 1.5);
  for (std::size_t b = 0; b < 8; ++b)
    for (auto& column : branches.arm) column[b] *= std::pow(10.0, -static_cast<double>(b));
  for (auto& column : branches.arm) column[8] = 0;
  const auto q = random_values(branches.size(), 34);
  const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, 1, LineIntegral::adaptive());
  const LeafBuffers bent = splat_contacts(lattice, kernel, branches, q, 1, LineIntegral::midpoint_curvature());
  const LeafBuffers exact = splat_contacts(lattice, kernel, branches, q, 1, LineIntegral::exact());
  const double peak = lucy_peak(scene.cutoff);
  for (const ReachedVoxel& v :
       weigh_branches(scene, branches, [&](const Vec3&p, const Vec3&a) { return kernel.line_integral(p, a); })) {
    EXPECT_EQ(is_active(*sums.topology(), v.voxel), is_active(*exact.topology(), v.voxel));
    double sum = 0, terms = 0, reached = 0;
    for (const auto& [b, w] : v.branches) {
      sum += q[b] * w;
      terms += std::abs(q[b]) * w;
      reached += std::abs(q[b]);
    }
    EXPECT_NEAR(value_at(sums, v.voxel, 0), sum, lucy_rule_error * peak * reached + bar * terms);
    EXPECT_NEAR(value_at(bent, v.voxel, 0), sum, curved_branch_error * peak * reached + bar * terms);
    EXPECT_NEAR(value_at(exact, v.voxel, 0), sum, 1e-12 * peak * reached);
  }
}

TEST_P(FastContactSplat, ErrsByNoMoreThanItsBoundOnContactsOnTheLineOfCentres) {
  // Both halves of every contact one after the other, up to 0.8 cutoffs long together; some points are a little off.
  HalfBranches contacts;
  const HalfBranches whole = random_branches(scene, 60, 41, 0.01, 0.8);
  std::vector<double> q;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const double share = 0.1 + 0.8 * static_cast<double>(k) / static_cast<double>(whole.size());
    const double off = k % 5 == 0 ? 1e-3 * scene.cutoff : k % 5 == 1 ? 1e-7 * scene.cutoff : 0;
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t a = 0; a < 3; ++a) {
        const double l = whole.arm[a][k], x = whole.start[a][k];
        contacts.start[a].push_back(side == 0 ? x : x - l);
        contacts.arm[a].push_back((side == 0 ? share : share - 1) * l + (a == 0 ? off : 0));
        contacts.force[a].push_back(side == 0 ? whole.force[a][k] : -whole.force[a][k]);
      }
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q.push_back(-contacts.force[i].back() * contacts.arm[j].back());
    }
  }
  branches = contacts;
  const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, 9, LineIntegral::adaptive());
  const LeafBuffers exact = splat_contacts(lattice, kernel, branches, q, 9, LineIntegral::exact());
  EXPECT_EQ(sums.topology()->active_voxel_count(), exact.topology()->active_voxel_count());
  const double peak = lucy_peak(scene.cutoff);
  for (const ReachedVoxel& v :
       weigh_branches(scene, branches, [&](const Vec3&p, const Vec3&a) { return kernel.line_integral(p, a); })) {
    EXPECT_EQ(is_active(*sums.topology(), v.voxel), is_active(*exact.topology(), v.voxel));
    for (std::size_t c = 0; c < 9; ++c) {
      double terms = 0, reached = 0;
      for (const auto& [b, w] : v.branches) {
        terms += std::abs(q[9 * b + c]) * w;
        reached += std::abs(q[9 * b + c]);
      }
      EXPECT_NEAR(value_at(sums, v.voxel, static_cast<int>(c)), value_at(exact, v.voxel, static_cast<int>(c)),
                  lucy_rule_error * peak * reached + bar * terms);
    }
  }
}

TEST_P(FastContactSplat, TheScaleOfTheValuesDoesNotMatter) {
  // 1e-60 and 1e60 are beyond the range of single precision.
  auto q = random_values(branches.size() * 4, 28);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    q[4 * b] *= 1e-60;
    q[4 * b + 1] *= 1e60;
    q[4 * b + 2] = 0;
  }
  expect_equal(q, 4, LineIntegral::adaptive(), weigh(LineIntegral::adaptive()));
}

TEST_P(FastContactSplat, AChannelThatFewBranchesHaveIsRightAtTheirRims) {
  // Where a channel is zero or tiny for most branches, the rims of the others' supports are all there is of it.
  auto q = random_values(branches.size() * 2, 29);
  for (std::size_t b = 0; b < branches.size(); ++b) q[2 * b] *= b % 15 == 0 ? 1 : b % 2 == 0 ? 0 : 1e-9;
  expect_equal(q, 2, LineIntegral::adaptive(), weigh(LineIntegral::adaptive()));
}

TEST_P(FastContactSplat, GivesTheSameBytesForAnyThreads) {
  branches = random_branches(scene, 800, 30, 0, 0.8);
  const auto q = random_values(branches.size() * 9, 27);
  for (const LineIntegral method : {LineIntegral::adaptive(), LineIntegral::gauss(2)})
    expect_same_bytes_for_any_threads([&] { return splat_contacts(lattice, kernel, branches, q, 9, method); });
}

INSTANTIATE_TEST_SUITE_P(Scenes, FastContactSplat, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

// Voxels at a distance of exactly one cutoff, beside, before and beyond branches along the axes and of no length: none
// of them belongs to the topology, whatever single precision makes of their distances.
TEST(ContactTopology, IsDecidedInDoublePrecision) {
  const Lattice lattice(0.125, {0, 0, 0});  // positions and distances are exact in binary
  const LucyKernel kernel(0.75);
  for (const double depth : {0.0, 0x1p-50, -0x1p-50}) {
    HalfBranches branches;
    // From the centre of voxel (0, 0, 0) to that of voxel (4, 0, 0); a point off by `depth` reaches one side only.
    branches.start = {{{0.5625, 0.0625}, {0.0625, 3.0625 + depth}, {0.0625, 0.0625}}};
    branches.arm = {{{0.5, 0}, {0, 0}, {0, 0}}};
    const std::vector<double> q{1, 1};
    for (const LineIntegral method : {LineIntegral::adaptive(), LineIntegral::gauss(1), LineIntegral::exact()}) {
      const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, 1, method);
      const auto active = [&](int x, int y, int z) { return is_active(*sums.topology(), {x, y, z}); };
      for (int x = 0; x <= 4; ++x) {
        EXPECT_FALSE(active(x, 6, 0));
        EXPECT_TRUE(active(x, 5, 0));
      }
      EXPECT_FALSE(active(-6, 0, 0));
      EXPECT_TRUE(active(-5, 0, 0));
      EXPECT_FALSE(active(10, 0, 0));
      EXPECT_TRUE(active(9, 0, 0));
      EXPECT_EQ(active(0, 18, 0), depth < 0);
      EXPECT_EQ(active(0, 30, 0), depth > 0);
    }
  }
}

}  // namespace
}  // namespace grainvdb::fast_contacts_test
