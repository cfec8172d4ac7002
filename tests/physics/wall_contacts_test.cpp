// Contacts with walls that are no grains: what they do to stresses and to the force of walls.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::wall_contacts_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// Grains on two meshes, by LIGGGHTS: one in the corner and one that leans on it, at rest; one that rolls; one in the
/// air.
InputSpec mesh_input() {
  const auto file = [](const std::string& name) {
    return in_repository("sample_dumps/formats/" + name + "_2000.dump");
  };
  InputSpec input;
  input.particles = {file("mesh_grains")};
  input.contacts.files = {file("mesh_pairs")};
  input.contacts.columns = {{"id1", {"c_cl[1]"}}, {"id2", {"c_cl[2]"}}, {"force", {"c_cl[4]", "c_cl[5]", "c_cl[6]"}}};
  input.wall_contacts.files = {file("mesh_walls")};
  input.wall_contacts.compute = {"pos", "id", "force", "contactPoint"};
  input.units = "si";
  input.dt = 1e-5;
  return input;
}

/// The same as MercuryDPM would write it: contacts with walls stand among the others.
InputSpec mercury_input() {
  InputSpec input;
  input.particles = {in_repository("sample_dumps/formats/mesh_mercury.data")};
  input.wall_contacts.files = {in_repository("sample_dumps/formats/mesh_mercury.fstat")};
  input.periodic = "none";
  return input;
}

Pipeline mesh_pipeline(std::vector<std::string> fields) {
  Pipeline p = make_pipeline(2.5e-4, {0, 0, 0}, 1.5e-3, std::move(fields));
  p.input = mesh_input();
  if (const auto stress = p.stages.find("contact_stress"); stress != p.stages.end())
    stress->second.at("line_integral") = std::string("exact");
  return p;
}

std::vector<double> integral(const FieldCopy& field, const Pipeline& p, int components) {
  std::vector<double> sum(static_cast<std::size_t>(components));
  field.for_each_active([&](const Coord& c) {
    for (int k = 0; k < components; ++k)
      sum[static_cast<std::size_t>(k)] += std::pow(p.voxel, 3) * static_cast<double>(field.at(c, k));
  });
  return sum;
}

/// What h³ Σ W is off at most, and single precision.
double sum_error(const Pipeline& p) {
  return grain_volume_error(p.cutoff / p.voxel) + 1e-5;
}

// The total force on the grains, which the particle dump has, is their weight and what the meshes bear: those between
// grains cancel. Where grains rest it is zero.
TEST(WallContacts, ClosesTheBalanceOfMomentum) {
  const double gravity = 9.81;
  const Vec3 down{0, -0.196116135, -0.980580676};
  Pipeline p = mesh_pipeline({"wall_force"});
  const Frame frame = open_dumps(p.input)->read(0, Column::force | Column::mass);
  Vec3 borne{};
  double scale = 0;
  for (std::size_t i = 0; i < frame.particles.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      const double weight = frame.particles.mass[i] * gravity * down[a];
      borne[a] += frame.particles.force[a][i] - weight;
      scale += std::abs(weight);
    }
  for (const InputSpec& input : {mesh_input(), mercury_input()}) {
    p.input = input;
    const Result r = run(p, *open_dumps(p.input));
    const std::vector<double> found = integral(r.only().field("wall_force"), p, 3);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(found[a], borne[a], sum_error(p) * scale) << input.particles[0];
  }
  EXPECT_GT(borne[2], 2 * frame.particles.mass[0] * gravity * 0.98);  // of three grains, and not of the one in the air
}

// Σ F W(x - c) at every voxel, to the 1e-5 that single precision leaves of each of the four terms.
TEST(WallContacts, ForceLiesAtTheContactPoints) {
  const Pipeline p = mesh_pipeline({"wall_force"});
  const auto source = open_dumps(p.input);
  const WallContacts contacts = source->read(0, Column::wall_contacts).wall_contacts;
  const LucyKernel kernel(p.cutoff);
  const FieldCopy field = run(p, *source).only().field("wall_force");
  double largest = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) largest = std::max(largest, std::abs(contacts.force[a][k]));
  std::size_t voxels = 0;
  field.for_each_active([&](const Coord& c) {
    ++voxels;
    for (std::size_t a = 0; a < 3; ++a) {
      double sum = 0;
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        double square = 0;
        for (std::size_t b = 0; b < 3; ++b)
          square += std::pow((c[static_cast<int>(b)] + 0.5) * p.voxel - contacts.point[b][k], 2);
        sum += contacts.force[a][k] * kernel.value(square);
      }
      EXPECT_NEAR(static_cast<double>(field.at(c, static_cast<int>(a))), sum, 4e-5 * largest * kernel.value(0));
    }
  });
  EXPECT_GT(voxels, 500U);
}

// ∫ σ dV = -Σ F ⊗ a: over the contact of two grains, whose whole branch joins their centres, and from centres to
// meshes.
TEST(WallContacts, StressIsThatOfBranchesToTheContactPoints) {
  Pipeline p = mesh_pipeline({"contact_stress"});
  const auto source = open_dumps(p.input);
  const Frame frame = source->read(0, Column::contacts | Column::wall_contacts);
  const auto row = [&](std::int64_t id) {
    const auto& ids = frame.particles.id;
    return static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
  };
  const auto& x = frame.particles.position;
  std::array<double, 9> expected{};
  double scale = 0;
  const auto add = [&](const Columns3& force, std::size_t k, const Vec3& branch) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        expected[3 * i + j] -= force[i][k] * branch[j];
        scale += std::abs(force[i][k] * branch[j]);
      }
  };
  for (std::size_t k = 0; k < frame.contacts.size(); ++k) {
    const std::size_t i = row(frame.contacts.id1[k]), j = row(frame.contacts.id2[k]);
    add(frame.contacts.force, k, {x[0][i] - x[0][j], x[1][i] - x[1][j], x[2][i] - x[2][j]});
  }
  for (std::size_t k = 0; k < frame.wall_contacts.size(); ++k) {
    const std::size_t i = row(frame.wall_contacts.id[k]);
    const Columns3& c = frame.wall_contacts.point;
    add(frame.wall_contacts.force, k, {x[0][i] - c[0][k], x[1][i] - c[1][k], x[2][i] - c[2][k]});
  }
  for (const std::string walls : {"include", "exclude"}) {
    set_option(p, "contact_stress", "wall_contacts", walls);
    const std::vector<double> found = integral(run(p, *source).only().field("contact_stress"), p, 9);
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(found[k], expected[k], sum_error(p) * scale) << walls << k;
  }
  // Pressed between floor and weight: the share of a contact with the floor is F_z r.
  EXPECT_LT(expected[8], -3 * 1.2e-5 * 4.9e-4);
}

struct Sides {
  Frame with_wall_grains, with_walls;
};

/// The same frame with its contacts between grains of type 1 and others as such, and as contacts with walls.
Sides both_sides(const Frame& frame) {
  Sides sides{frame, frame};
  const auto is_material = [&](std::int64_t id) {
    const auto& ids = frame.particles.id;
    return frame.particles.type[static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin())] ==
           1;
  };
  Contacts between_grains;
  WallContacts& walls = sides.with_walls.wall_contacts;
  for (std::size_t k = 0; k < frame.contacts.size(); ++k) {
    const std::int64_t id1 = frame.contacts.id1[k], id2 = frame.contacts.id2[k];
    Vec3 force, point;
    for (std::size_t a = 0; a < 3; ++a) {
      force[a] = frame.contacts.force[a][k];
      point[a] = frame.contacts.point[a][k];
    }
    if (is_material(id1) && is_material(id2)) add_contact(between_grains, id1, id2, force, point);
    if (is_material(id1) == is_material(id2)) continue;
    walls.id.push_back(is_material(id1) ? id1 : id2);
    for (std::size_t a = 0; a < 3; ++a) {
      walls.force[a].push_back(is_material(id1) ? force[a] : -force[a]);
      walls.point[a].push_back(point[a]);
    }
  }
  sides.with_walls.contacts = between_grains;
  return sides;
}

// A mesh is a wall grain whose half of the branch is left out: the sums are the same to the bit, as their order is.
TEST(WallContacts, AreContactsWithWallGrainsWithoutTheirHalfBranches) {
  const Scene scene = walled_scene();
  const Sides sides = both_sides(scene.frames[0]);
  ASSERT_GT(sides.with_walls.wall_contacts.size(), 5U);
  Pipeline p = scene.pipeline({"wall_force", "contact_stress"});
  set_option(p, "contact_stress", "wall_contacts", std::string("exclude"));
  const Result grains = run(p, {sides.with_wall_grains});
  for (const std::string wall_contacts : {"exclude", "include"}) {
    set_option(p, "contact_stress", "wall_contacts", wall_contacts);
    const Result walls = run(p, {sides.with_walls});
    for (const auto& [name, components] : {std::pair<std::string, int>{"wall_force", 3}, {"contact_stress", 9}}) {
      const FieldCopy &a = grains.only().field(name), &b = walls.only().field(name);
      double largest = 0;
      a.for_each_active([&](const Coord& c) {
        for (int k = 0; k < components; ++k) {
          EXPECT_EQ(a.at(c, k), b.at(c, k)) << name << ' ' << wall_contacts;
          largest = std::max(largest, std::abs(static_cast<double>(a.at(c, k))));
        }
      });
      EXPECT_GT(largest, 0) << name;
    }
  }
}

TEST(WallContacts, OfWallGrainsDoNotCount) {
  Frame frame = both_sides(walled_scene().frames[0]).with_walls;
  Pipeline p = walled_scene().pipeline({"wall_force"});
  const FieldCopy before = run(p, {frame}).only().field("wall_force");
  ASSERT_NE(frame.particles.type.back(), 1);
  frame.wall_contacts.id.push_back(frame.particles.id.back());
  for (std::size_t a = 0; a < 3; ++a) {
    frame.wall_contacts.force[a].push_back(100);
    frame.wall_contacts.point[a].push_back(frame.particles.position[a].back());
  }
  const FieldCopy after = run(p, {frame}).only().field("wall_force");
  EXPECT_EQ(before.values, after.values);
}

TEST(WallContacts, AreReadOnlyWhereSumsOverContactsAreWanted) {
  Pipeline p = mesh_pipeline({"phi"});
  EXPECT_EQ(make_plan(p).sweeps.at(0).columns, ColumnSet(Column::radius));
  p.fields = {"contact_stress"};
  EXPECT_EQ(make_plan(p).sweeps.at(0).columns, (Column::radius | Column::contacts) | Column::wall_contacts);
  // Without wall grains, contacts between grains say nothing about the force of walls.
  p.fields = {"wall_force"};
  EXPECT_EQ(make_plan(p).sweeps.at(0).columns, Column::radius | Column::wall_contacts);
  p.walls.types = {2};
  EXPECT_TRUE(make_plan(p).sweeps.at(0).columns.has(Column::contacts));
  p.walls.types.clear();
  p.select.types = {1};
  EXPECT_TRUE(make_plan(p).sweeps.at(0).columns.has(Column::contacts));
  p.select = {};
  p.input.wall_contacts = {};
  p.fields = {"contact_stress"};
  EXPECT_EQ(make_plan(p).sweeps.at(0).columns, Column::radius | Column::contacts);

  p = mesh_pipeline({"wall_force"});
  const auto source = open_dumps(p.input);
  run(p, *source);
  EXPECT_THAT(source->counters().files_opened, Contains(HasSubstr("mesh_walls")));
  EXPECT_THAT(source->counters().files_opened, Not(Contains(HasSubstr("mesh_pairs"))));
}

TEST(WallContacts, DoNotStandForContactsBetweenGrains) {
  Pipeline p = mesh_pipeline({"contact_stress"});
  p.input.contacts = {};
  const auto source = open_dumps(p.input);
  EXPECT_THROW(run(p, *source), ConfigError);
  p.fields = {"wall_force"};
  EXPECT_NO_THROW(run(p, *source));
}

}  // namespace
}  // namespace grainvdb::testing::wall_contacts_test
