#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "bin/branches.hpp"
#include "splat/splat.hpp"
#include "unit/splat/branch_scene.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::contacts_test {
namespace {

constexpr LineIntegral exact = LineIntegral::exact();

class ContactSplat : public testing::TestWithParam<Scene> {
 protected:
  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  HalfBranches branches = random_branches(scene, 24, 21);
};

TEST_P(ContactSplat, TopologyIsWhereTheLineIntegralIsPositive) {
  const LeafBuffers sums =
      splat_contacts(lattice, kernel, branches, std::vector<double>(branches.size(), 1.0), 1, exact);
  std::size_t active = 0;
  for (const Coord& voxel : scene.voxels(1.5 * scene.cutoff + 2 * scene.voxel)) {
    bool inside = false, at_rim = false;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const Vec3 arm = row(branches.arm, b);
      for (const Vec3& p : images_in_reach(scene, lattice.centre(voxel), row(branches.start, b), arm)) {
        inside = true;
        at_rim = at_rim || segment_distance(p, arm) > scene.cutoff * (1 - 1e-12);
      }
    }
    const bool found = is_active(*sums.topology(), voxel);
    active += found ? 1U : 0U;
    EXPECT_TRUE(at_rim || found == inside) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
    EXPECT_EQ(value_at(sums, voxel, 0) > 0, found);
  }
  EXPECT_EQ(sums.topology()->active_voxel_count(), active) << "a voxel outside the stored period";
  expect_zero_where_inactive(sums);
}

// The reference sums W at the 8 points of a Gauss rule on each of 16 parts of the branch.
TEST_P(ContactSplat, SumsEqualTheBruteForce) {
  const int channels = 2;
  const auto q = random_values(branches.size() * channels, 22);
  const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, channels, exact);
  const double shift = position_error(branches.start);
  const int parts = 16;
  for (const Coord& voxel : scene.voxels(1.5 * scene.cutoff + 2 * scene.voxel)) {
    double sum[2] = {}, terms[2] = {}, reached[2] = {};
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const Vec3 arm = row(branches.arm, b);
      for (const Vec3& p : images_in_reach(scene, lattice.centre(voxel), row(branches.start, b), arm)) {
        double mean = 0;
        for (int k = 0; k < parts; ++k) {
          const double s = static_cast<double>(k) / parts;
          const Vec3 part{arm[0] / parts, arm[1] / parts, arm[2] / parts};
          mean +=
              kernel.line_integral_gauss({p[0] + s * arm[0], p[1] + s * arm[1], p[2] + s * arm[2]}, part, 8) / parts;
        }
        for (std::size_t c = 0; c < 2; ++c) {
          const double value = q[b * channels + c];
          sum[c] += value * mean;
          terms[c] += std::abs(value) * mean;
          reached[c] += std::abs(value);
        }
      }
    }
    for (std::size_t c = 0; c < 2; ++c) {
      // The rule of the reference errs most where a part of length at most c/32 passes the centre: 7e-7 W(0) for a
      // branch of c/6 falls with the cube of the length, and counts for one part of 16.
      const double reference_error = 7.1e-7 * std::pow(6.0 / 32, 3) / parts * lucy_peak(scene.cutoff);
      const double tolerance =
          1e-13 * terms[c] + reached[c] * largest_gradient(scene.cutoff) * shift + reached[c] * reference_error;
      EXPECT_NEAR(value_at(sums, voxel, static_cast<int>(c)), sum[c], tolerance);
    }
  }
}

// At each voxel the same as the kernel's own integrals, to rounding.
TEST_P(ContactSplat, IsTheSumOfItsLineIntegrals) {
  const auto q = random_values(branches.size(), 23);
  const double shift = position_error(branches.start);
  const LeafBuffers sums = splat_contacts(lattice, kernel, branches, q, 1, exact);
  for (const ReachedVoxel& v :
       weigh_branches(scene, branches, [&](const Vec3&p, const Vec3&a) { return kernel.line_integral(p, a); })) {
    double sum = 0, terms = 0, reached = 0;
    for (const auto& [b, w] : v.branches) {
      sum += q[b] * w;
      terms += std::abs(q[b]) * w;
      reached += std::abs(q[b]);
    }
    const double tolerance =
        1e-13 * terms + reached * largest_gradient(scene.cutoff) * shift + 1e-14 * reached * lucy_peak(scene.cutoff);
    EXPECT_NEAR(value_at(sums, v.voxel, 0), sum, tolerance);
  }
  expect_zero_where_inactive(sums);
}

// At the voxels of more branches the sums of some are what they are by themselves, and 0 where these do not reach.
TEST_P(ContactSplat, MayHaveMoreVoxelsThanItReaches) {
  const HalfBranches some = random_branches(scene, 5, 26);
  const auto q = random_values(some.size(), 27);
  HalfBranches more = branches;
  for (std::size_t b = 0; b < some.size(); ++b)
    for (std::size_t a = 0; a < 3; ++a) {
      more.start[a].push_back(some.start[a][b]);
      more.arm[a].push_back(some.arm[a][b]);
      more.force[a].push_back(some.force[a][b]);
    }
  for (const LineIntegral method : {exact, LineIntegral::adaptive()}) {
    const LeafBuffers own = splat_contacts(lattice, kernel, some, q, 1, method);
    const LeafBuffers all = splat_contacts(lattice, kernel, more, random_values(more.size(), 28), 1, method);
    LeafBuffers found(all.topology(), 1);
    const grainvdb::ContactSplat splat(lattice, kernel, some, q, 1, method, nullptr, all.topology());
    splat.sums([&](std::size_t leaf, const double* values) { std::copy_n(values, leaf_size, found.block(leaf, 0)); });
    std::size_t beyond = 0;
    for (std::size_t leaf = 0; leaf < all.topology()->leaf_count(); ++leaf)
      all.topology()->mask(leaf).for_each([&](int v) {
        const Coord voxel = voxel_at(all.topology()->origin(leaf), v);
        EXPECT_EQ(value_at(found, voxel, 0), value_at(own, voxel, 0));
        if (!is_active(*own.topology(), voxel)) ++beyond;
      });
    EXPECT_GT(beyond, 100U);
  }
  grainvdb::ContactSplat(
      lattice, kernel, {}, {}, 1, exact, nullptr,
      splat_contacts(lattice, kernel, branches, std::vector<double>(branches.size()), 1, exact).topology())
      .sums([](std::size_t, const double*) { ADD_FAILURE() << "there is nothing to hand over"; });
}

TEST_P(ContactSplat, BytesDoNotDependOnThreads) {
  const HalfBranches many = random_branches(scene, 1000, 24);
  const auto q = random_values(many.size() * 2, 25);
  expect_same_bytes_for_any_threads([&] { return splat_contacts(lattice, kernel, many, q, 2, exact); });
}

INSTANTIATE_TEST_SUITE_P(Scenes, ContactSplat, testing::ValuesIn(scenes()),
                         [](const auto& each) { return each.param.name; });

// A contact across a corner of a periodic box of 24 voxels, c/h = 6; the force is not along the branch.
Frame one_contact(bool with_point) {
  Frame frame;
  frame.file = "dump";
  frame.box = {{0, 0, 0}, {4, 4, 4}, {true, true, true}};
  frame.particles.id = {1, 2};
  frame.particles.position = {{{0.05, 3.85}, {3.9, 0.08}, {1.3, 1.45}}};
  frame.particles.radius = {0.15, 0.2};
  frame.contacts.id1 = {1};
  frame.contacts.id2 = {2};
  frame.contacts.force = {{{1.5}, {-0.7}, {2.0}}};
  const double share = 0.15 / 0.35;
  if (with_point) frame.contacts.point = {{{0.05 - share * 0.2}, {3.9 + share * 0.18}, {1.3 + share * 0.15}}};
  return frame;
}

TEST(ContactStress, VolumeIntegralIsMinusForceTimesBranch) {
  const Vec3 l{0.2, -0.18, -0.15};  // x_1 - x_2, minimum image
  const Vec3 force{1.5, -0.7, 2.0};
  for (bool with_point : {false, true}) {
    const Frame frame = one_contact(with_point);
    Lattice lattice(1.0 / 6, {0.02, 0, 0});
    lattice.set_periods(frame.box);
    const HalfBranches branches = half_branches(frame);
    std::vector<double> q;
    for (std::size_t b = 0; b < branches.size(); ++b)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q.push_back(-branches.force[i][b] * branches.arm[j][b]);
    for (const LineIntegral method :
         {exact, LineIntegral::adaptive(), LineIntegral::gauss(1), LineIntegral::gauss(4)}) {
      const LeafBuffers sigma = splat_contacts(lattice, LucyKernel(1), branches, q, 9, method);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          double integral = 0;
          for (std::size_t leaf = 0; leaf < sigma.topology()->leaf_count(); ++leaf)
            for (int o = 0; o < leaf_size; ++o) integral += sigma.block(leaf, static_cast<int>(3 * i + j))[o] / 216;
          // Each point of the branch is a kernel that the lattice sums to 1 within 2.4e-5 at c/h = 6.
          EXPECT_NEAR(integral, -force[i] * l[j], 2.4e-5 * std::abs(force[i] * l[j])) << method.gauss_points;
        }
    }
  }
}

TEST(ContactSplatMethods, GaussRulesErrAsTheKernelsBoundsSay) {
  // One branch of length c/6 through a voxel centre, which is the worst case, and ones at random.
  const Scene scene{"open", {{-1, -1, -1}, {1, 1, 1}, {false, false, false}}, 1.0 / 6, {0, 0, 0}, 1};
  const Lattice lattice = scene.lattice();
  const LucyKernel kernel(1);
  HalfBranches branches;
  const Vec3 centre = lattice.centre({0, 0, 0});
  branches.start = {{{centre[0] + 1.0 / 12}, {centre[1]}, {centre[2]}}};
  branches.arm = {{{1.0 / 6}, {0}, {0}}};
  const double q = 1;
  const LeafBuffers reference = splat_contacts(lattice, kernel, branches, {&q, 1}, 1, exact);
  const double bound[] = {1.28e-2, 2.54e-4, 3.80e-5, 1.04e-5, 4.77e-6, 2.08e-6, 1.29e-6, 7.1e-7};
  for (int n = 1; n <= 8; ++n) {
    const LeafBuffers sums = splat_contacts(lattice, kernel, branches, {&q, 1}, 1, LineIntegral::gauss(n));
    double worst = 0;
    for (const Coord& voxel : scene.voxels(1.5))
      worst = std::max(worst, std::abs(value_at(sums, voxel, 0) - value_at(reference, voxel, 0)) / lucy_peak(1));
    EXPECT_LE(worst, bound[n - 1] + 2e-7) << n;  // some roundings of single precision
    EXPECT_GE(worst, 0.9 * bound[n - 1]) << n;
  }
}

TEST(ContactSplatMethods, ArmOfNoLengthIsAParticle) {
  const Lattice lattice(0.5, {0, 0, 0});
  const LucyKernel kernel(1.3);
  HalfBranches branches;
  branches.start = {{{0.1}, {0.2}, {0.3}}};
  branches.arm = {{{0}, {0}, {0}}};
  const double q = 3;
  const Buckets b = bin_points(lattice, branches.start, 1.3);
  const auto topology = particle_topology(lattice, kernel, b);
  const LeafBuffers particle = splat_particles(lattice, kernel, b, topology, {&q, 1}, 1);
  for (const LineIntegral method : {exact, LineIntegral::adaptive(), LineIntegral::gauss(3)}) {
    const LeafBuffers sums = splat_contacts(lattice, kernel, branches, {&q, 1}, 1, method);
    ASSERT_EQ(sums.topology()->active_voxel_count(), topology->active_voxel_count());
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      for (int o = 0; o < leaf_size; ++o)
        EXPECT_NEAR(sums.block(l, 0)[o], particle.block(l, 0)[o],
                    method == exact ? 1e-14 * lucy_peak(1.3) : 1e-5 * particle.block(l, 0)[o]);
  }
}

TEST(ContactSplatMethods, NoBranchesGiveNoVoxels) {
  for (const LineIntegral method : {exact, LineIntegral::adaptive(), LineIntegral::gauss(3)}) {
    const LeafBuffers sums = splat_contacts(Lattice(1, {0, 0, 0}), LucyKernel(2), HalfBranches{}, {}, 9, method);
    EXPECT_EQ(sums.topology()->leaf_count(), 0u);
    EXPECT_EQ(sums.channels(), 9);
  }
}

TEST(ContactSplatMethods, RefusesWrongNumbersOfValues) {
  HalfBranches branches;
  branches.start = branches.arm = {{{0}, {0}, {0}}};
  const std::vector<double> q(8);
  EXPECT_THROW(splat_contacts(Lattice(1, {0, 0, 0}), LucyKernel(2), branches, q, 9, exact), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::contacts_test
