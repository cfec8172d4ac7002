// Exact statements about the stress.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bin/branches.hpp"
#include "grainvdb/kernel.hpp"
#include "support/kernel_sums.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::stress_identities_test {
namespace {

using Sum9 = std::array<double, 9>;

Sum9 volume_integral(const FieldCopy& f, double h) {
  Sum9 sum{};
  f.for_each_active([&](const Coord& c) {
    for (int k = 0; k < 9; ++k) sum[static_cast<std::size_t>(k)] += h * h * h * static_cast<double>(f.at(c, k));
  });
  return sum;
}

// ∫ σ dV = -Σ F ⊗ l - Σ m u' u' (physics section 6), l the full branch from 2 to 1, u' about the frame's velocity at
// the particle. h³ Σ W is good to 1.5e-4 at c/h = 5.4 (2.4e-5 at 6, 3.3e-4 at 4) per half branch and particle, and the
// mean over a branch to less.
TEST(StressIdentities, VolumeIntegralInAPeriodicBox) {
  const Scene scene = periodic_scene();
  const Frame& f = scene.frames[0];
  for (const char* method : {"adaptive", "exact", "gauss1", "gauss2", "gauss3", "gauss5", "gauss8"}) {
    SCOPED_TRACE(method);
    Pipeline p = scene.pipeline({"contact_stress", "kinetic_stress", "stress"});
    set_option(p, "contact_stress", "line_integral", std::string(method));
    set_option(p, "kinetic_stress", "reference", std::string("instantaneous"));
    const Result r = run(p, {f});

    Sum9 contact{};
    Sum9 kinetic{};
    double scale = 0;
    for (std::size_t k = 0; k < f.contacts.size(); ++k) {
      std::array<Vec3, 2> x;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t e = 0; e < 2; ++e) {
          const auto id = e == 0 ? f.contacts.id1[k] : f.contacts.id2[k];
          const auto row = std::lower_bound(f.particles.id.begin(), f.particles.id.end(), id) - f.particles.id.begin();
          x[e][a] = f.particles.position[a][static_cast<std::size_t>(row)];
        }
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          const double l = f.box.minimum_image(static_cast<int>(j), x[0][j] - x[1][j]);
          contact[3 * i + j] -= f.contacts.force[i][k] * l;
          scale += std::abs(f.contacts.force[i][k] * l) / 3;
        }
    }
    const VoxelBox box({f}, scene.voxel, scene.origin, scene.cutoff);
    const Particles& q = f.particles;
    std::vector<double> weight;
    std::vector<double> momentum;
    for (std::size_t n = 0; n < q.size(); ++n) {
      weight.push_back(std::pow(q.radius[n], 3));
      for (std::size_t a = 0; a < 3; ++a) momentum.push_back(weight.back() * q.velocity[a][n]);
    }
    const std::vector<Vec3> u = interpolate(box, particle_sums(box, scene.cutoff, q, momentum, 3),
                                            particle_sums(box, scene.cutoff, q, weight, 1), q.position);
    for (std::size_t n = 0; n < q.size(); ++n)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          const double term = q.mass[n] * (q.velocity[i][n] - u[n][i]) * (q.velocity[j][n] - u[n][j]);
          kinetic[3 * i + j] -= term;
          scale += std::abs(term) / 3;
        }

    const Sum9 found_contact = volume_integral(r.only().field("contact_stress"), scene.voxel);
    const Sum9 found_kinetic = volume_integral(r.only().field("kinetic_stress"), scene.voxel);
    const Sum9 found = volume_integral(r.only().field("stress"), scene.voxel);
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_NEAR(found_contact[k], contact[k], 1.5e-4 * scale) << k;
      EXPECT_NEAR(found_kinetic[k], kinetic[k], 1.5e-4 * scale) << k;
      EXPECT_NEAR(found[k], contact[k] + kinetic[k], 1.5e-4 * scale) << k;
    }
  }
}

// Columns of grains at rest on a floor, each contact carrying the weight above it: -A σ_zz(z) = g Σ m CDF((z_α - z)/c)
// for z > c (physics section 6), whatever the branches' directions. The sum over the voxels of a layer stands for the
// integral over the base, which is good to the lattice sum of W in two dimensions: 1e-4 of the weight at c/h = 6.
TEST(StressIdentities, StaticColumn) {
  const StaticColumns columns(31);
  const double h = 0.5;
  const double c = 3;
  Pipeline p = make_pipeline(h, {0, 0, 0.1}, c, {"contact_stress"});
  set_option(p, "contact_stress", "line_integral", std::string("exact"));
  p.select.types = {1};
  const Result r = run(p, {columns.frame});
  const FieldCopy& s = r.only().field("contact_stress");

  const double total = columns.total_weight();
  for (int k = 6; k < 22; ++k) {  // from z = 3.35 > c, below which the floor's branches begin to count
    double force = 0;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 13; ++j) force -= h * h * static_cast<double>(s.at({i, j, k}, 8));
    const double z = 0.1 + (k + 0.5) * h;
    double expected = 0;
    for (std::size_t n = 0; n < columns.height.size(); ++n)
      expected += columns.weight[n] * marginal_cdf((columns.height[n] - z) / c);
    EXPECT_NEAR(force, expected, 1e-4 * total) << "z = " << z;
    EXPECT_GT(expected, 10 * 1e-4 * total);
  }
}

// The same to rounding, where nothing is summed over voxels: ∫∫ ∫₀¹ W(x - x_α + s a) ds dx dy is the difference of the
// marginal's integral between the two ends of a branch, over a_z.
TEST(StressIdentities, StaticColumnToRounding) {
  const StaticColumns columns(31);
  const LucyKernel kernel(3);
  const HalfBranches branches = half_branches(columns.frame);
  const double total = columns.total_weight();
  for (double z = 3.35; z < 14; z += 0.25) {
    double force = 0, expected = 0;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const double start = branches.start[2][b], arm = branches.arm[2][b];
      force += branches.force[2][b] * (kernel.marginal_integral(z - start + arm) - kernel.marginal_integral(z - start));
    }
    for (std::size_t n = 0; n < columns.height.size(); ++n)
      expected += columns.weight[n] * marginal_cdf((columns.height[n] - z) / 3);
    EXPECT_NEAR(force, expected, 1e-10 * total) << "z = " << z;
  }
}

// Each Gauss-Legendre rule, at every voxel.
TEST(StressIdentities, GaussRulesFromTheirNodes) {
  const Scene scene = periodic_scene();
  const Frame& f = scene.frames[1];
  const VoxelBox box({f}, scene.voxel, scene.origin, scene.cutoff);
  const Branches b = branches_of(f);
  std::vector<double> q;
  for (std::size_t k = 0; k < b.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) q.push_back(-b.force[k][i] * b.arm[k][j]);
  for (int n = 1; n <= 8; ++n) {
    SCOPED_TRACE("gauss" + std::to_string(n));
    Pipeline p = scene.pipeline({"contact_stress"});
    set_option(p, "contact_stress", "line_integral", "gauss" + std::to_string(n));
    const Result r = run(p, {f});
    const Sums expected = branch_sums(box, scene.cutoff, b, q, 9, n);
    std::size_t active = 0;
    r.only().field("contact_stress").for_each_active([&](const Coord& c) {
      ++active;
      const std::size_t v = box.index(c).value();
      for (int k = 0; k < 9; ++k)
        EXPECT_NEAR(static_cast<double>(r.only().field("contact_stress").at(c, k)), expected.at(v, k),
                    float_rounding * std::abs(expected.at(v, k)) + gauss_sum_rounding * expected.size(v, k));
    });
    EXPECT_EQ(active, static_cast<std::size_t>(std::count(expected.reached.begin(), expected.reached.end(), 1)));
  }
}

}  // namespace
}  // namespace grainvdb::testing::stress_identities_test
