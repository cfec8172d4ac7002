// The force of walls, and the balance of momentum that it closes.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/kernel_sums.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/static_columns.hpp"

namespace grainvdb::testing::wall_force_test {
namespace {

/// One half branch in a grain of type 1 with the type of its partner.
struct HalfContact {
  Vec3 point, arm, force;
  int partner;
};

std::vector<HalfContact> contacts_of_material(const Frame& f) {
  std::vector<HalfContact> found;
  const Branches b = branches_of(f);
  const auto type = [&](std::int64_t id) {
    const auto row = std::lower_bound(f.particles.id.begin(), f.particles.id.end(), id) - f.particles.id.begin();
    return f.particles.type[static_cast<std::size_t>(row)];
  };
  for (std::size_t n = 0; n < b.size(); ++n) {
    const std::size_t k = n / 2;
    const int own = type(n % 2 == 0 ? f.contacts.id1[k] : f.contacts.id2[k]);
    const int other = type(n % 2 == 0 ? f.contacts.id2[k] : f.contacts.id1[k]);
    if (own != 1) continue;
    Vec3 point;
    for (std::size_t a = 0; a < 3; ++a) point[a] = b.start[n][a] - b.arm[n][a];
    found.push_back({point, b.arm[n], b.force[n], other});
  }
  return found;
}

/// Σ over a layer of voxels times h²: the integral over the base.
double over_base(const FieldCopy& field, const Vec3& length, double h, int layer, int component) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(std::lround(length[0] / h)); ++i)
    for (int j = 0; j < static_cast<int>(std::lround(length[1] / h)); ++j)
      sum += h * h * static_cast<double>(field.at({i, j, layer}, component));
  return sum;
}

// With the half branches of wall grains left out and their forces as a density, the balance of momentum at rest,
// ∂σ_zz/∂z + f_z - ρg = 0, holds through the wall: integrated from z to infinity,
//   -A σ_zz(z) = Σ m g CDF((z_α - z)/c) - Σ F CDF((z_k - z)/c),
// F and z_k those of the contacts with wall grains. Sums over the voxels of a layer stand for integrals: at c/h = 12
// they are good to 3e-6, the 2^-5 of what they are at 6; the sums of wall_force to 1e-6 of their terms.
TEST(WallForce, ClosesTheBalanceOfAColumnAtRest) {
  const StaticColumns columns(31);
  const double h = 0.25;
  const double c = 3;
  Pipeline p = make_pipeline(h, {0, 0, 0.1}, c, {"contact_stress", "wall_force", "density"});
  set_option(p, "contact_stress", "line_integral", std::string("exact"));
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  p.select.types = {1};
  const Result r = run(p, {columns.frame});
  const FieldCopy& stress = r.only().field("contact_stress");
  const FieldCopy& force = r.only().field("wall_force");
  const Vec3 length{columns.frame.box.length(0), columns.frame.box.length(1), 0};
  const double bound = 1e-5 * columns.total_weight();
  double wall = 0, weight = 0;
  for (int k = -20; k < 80; ++k) {
    const double z = 0.1 + (k + 0.5) * h;
    double above = 0, density = 0;
    for (std::size_t n = 0; n < columns.height.size(); ++n)
      above += columns.weight[n] * marginal_cdf((columns.height[n] - z) / c);
    for (std::size_t n = 0; n < columns.foot_load.size(); ++n) {
      above -= columns.foot_load[n] * marginal_cdf((columns.foot_height[n] - z) / c);
      const double zeta = std::min(std::abs(columns.foot_height[n] - z) / c, 1.0);
      density += columns.foot_load[n] * 21 / (16 * c) * std::pow(1 - zeta, 4) * (1 + 4 * zeta + 5 * zeta * zeta);
    }
    EXPECT_NEAR(-over_base(stress, length, h, k, 8), above, bound) << "z = " << z;
    const double found = over_base(force, length, h, k, 2);
    EXPECT_NEAR(found, density, bound / c) << "z = " << z;
    for (int a : {0, 1}) EXPECT_EQ(over_base(force, length, h, k, a), 0) << "z = " << z;
    wall += h * found;
    weight += h * columns.gravity * over_base(r.only().field("density"), length, h, k, 0);
  }
  EXPECT_NEAR(wall, columns.total_weight(), bound);
  EXPECT_NEAR(weight, wall, bound);
}

/// Σ F W(x - c) against the field, at every voxel, to what single precision leaves of the terms.
void expect_sum_over_contacts(const Pipeline& p, const Frame& f, const std::vector<int>& wall_types) {
  const Result r = run(p, {f});
  const FieldCopy& field = r.only().field("wall_force");
  const std::vector<HalfContact> contacts = contacts_of_material(f);
  Vec3 total{}, integral{};
  double scale = 0;
  const auto at_wall = [&](const HalfContact& k) {
    return std::find(wall_types.begin(), wall_types.end(), k.partner) != wall_types.end();
  };
  std::size_t walls = 0;
  for (const HalfContact& k : contacts) {
    if (!at_wall(k)) continue;
    ++walls;
    for (std::size_t a = 0; a < 3; ++a) {
      total[a] += k.force[a];
      scale += std::abs(k.force[a]);
    }
  }
  ASSERT_GT(walls, 5U);
  field.for_each_active([&](const Coord& c) {
    Vec3 sum{}, size{};
    for (const HalfContact& k : contacts) {
      if (!at_wall(k)) continue;
      Vec3 d;
      for (std::size_t a = 0; a < 3; ++a) d[a] = p.origin[a] + (c[static_cast<int>(a)] + 0.5) * p.voxel - k.point[a];
      const double w = lucy_of_images(f.box, d, p.cutoff);
      for (std::size_t a = 0; a < 3; ++a) {
        sum[a] += k.force[a] * w;
        size[a] += std::abs(k.force[a]) * w;
      }
    }
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      const auto found = static_cast<double>(field.at(c, a));
      EXPECT_NEAR(found, sum[i], 1e-5 * size[i] + 1e-7 * scale / std::pow(p.cutoff, 3));
      integral[i] += std::pow(p.voxel, 3) * found;
    }
  });
  // What h³ Σ W is off at most at this c/h.
  const double error = grain_volume_error(p.cutoff / p.voxel);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(integral[a], total[a], error * scale);
}

TEST(WallForce, IsTheSumOverContactsWithWallGrains) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline({"wall_force"});
  p.select.types = {1};
  expect_sum_over_contacts(p, scene.frames[0], {2, 3});
  p.walls.types = {3};
  expect_sum_over_contacts(p, scene.frames[0], {3});
  // Wall grains that are selected are no material to other wall grains.
  p.select = {};
  expect_sum_over_contacts(p, scene.frames[0], {3});
}

// ∫ σ dV is -Σ F ⊗ a over the half branches that are kept.
TEST(WallForce, StressWithoutTheHalfBranchesOfWalls) {
  const Scene scene = walled_scene();
  const Frame& f = scene.frames[0];
  Pipeline p = scene.pipeline({"contact_stress"});
  p.select.types = {1};
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  std::array<double, 9> expected{}, found{};
  double scale = 0;
  for (const HalfContact& k : contacts_of_material(f))
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        expected[3 * i + j] -= k.force[i] * k.arm[j];
        scale += std::abs(k.force[i] * k.arm[j]) / 3;
      }
  const Result r = run(p, {f});
  r.only().field("contact_stress").for_each_active([&](const Coord& c) {
    for (int k = 0; k < 9; ++k)
      found[static_cast<std::size_t>(k)] +=
          std::pow(p.voxel, 3) * static_cast<double>(r.only().field("contact_stress").at(c, k));
  });
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_NEAR(found[k], expected[k], grain_volume_error(p.cutoff / p.voxel) * scale) << k;
}

TEST(WallForce, ReadsTypesAndContactsOnlyWhereItIsWanted) {
  Pipeline p = make_pipeline(1, {0, 0, 0}, 3, {"phi"});
  p.walls.types = {2};
  EXPECT_EQ(make_plan(p).sweeps.at(0).columns, ColumnSet(Column::radius));
  EXPECT_TRUE(make_plan(p).sweeps[0].branch_kinds.empty());
  p.fields = {"contact_stress"};
  EXPECT_FALSE(make_plan(p).sweeps[0].columns.has(Column::type));
  p.fields = {"wall_force"};
  EXPECT_EQ(make_plan(p).sweeps[0].columns, (Column::radius | Column::type) | Column::contacts);
  EXPECT_EQ(make_plan(p).sweeps[0].branch_kinds, std::set<BranchKind>{BranchKind::at_walls});
}

TEST(WallForce, WithoutKnownWallGrainsIsRefused) {
  const Scene scene = walled_scene();
  Pipeline p = make_pipeline(scene.voxel, scene.origin, scene.cutoff, {"wall_force"});
  EXPECT_THROW(run(p, scene.frames), ConfigError);
  p.fields = {"contact_stress"};
  EXPECT_NO_THROW(run(p, scene.frames));
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  EXPECT_THROW(run(p, scene.frames), ConfigError);
  p.walls.types = {2};
  EXPECT_NO_THROW(run(p, scene.frames));
}

}  // namespace
}  // namespace grainvdb::testing::wall_force_test
