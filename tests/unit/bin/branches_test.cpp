#include "bin/branches.hpp"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"

namespace grainvdb::branches_test {
namespace {

void add_particle(Frame& frame, std::int64_t id, const Vec3& x, double radius) {
  frame.particles.id.push_back(id);
  for (std::size_t a = 0; a < 3; ++a) frame.particles.position[a].push_back(x[a]);
  frame.particles.radius.push_back(radius);
}

void add_contact(Frame& frame, std::int64_t id1, std::int64_t id2, const Vec3& force) {
  frame.contacts.id1.push_back(id1);
  frame.contacts.id2.push_back(id2);
  for (std::size_t a = 0; a < 3; ++a) frame.contacts.force[a].push_back(force[a]);
}

void add_point(Frame& frame, const Vec3& c) {
  for (std::size_t a = 0; a < 3; ++a) frame.contacts.point[a].push_back(c[a]);
}

// Grains 7, 20 and 31 of radii 1, 0.5 and 1 in a box that is periodic in x.
Frame three_grains() {
  Frame frame;
  frame.file = "dump.5";
  frame.step = 5;
  frame.box = {{0, 0, 0}, {10, 10, 10}, {true, false, false}};
  add_particle(frame, 7, {0.5, 5, 5}, 1);
  add_particle(frame, 20, {9.1, 5, 5}, 0.5);
  add_particle(frame, 31, {2.4, 5, 5}, 1);
  return frame;
}

Vec3 row(const Columns3& columns, std::size_t k) {
  return {columns[0][k], columns[1][k], columns[2][k]};
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-14);
}

std::string message(const Frame& frame) {
  try {
    half_branches(frame);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(HalfBranches, OfNoContactsAreNone) {
  EXPECT_EQ(half_branches(three_grains()).size(), 0u);
}

TEST(HalfBranches, TwoPerContactWithOppositeForces) {
  Frame frame = three_grains();
  add_contact(frame, 7, 31, {1, 2, 3});
  add_point(frame, {1.45, 5, 5});
  const HalfBranches b = half_branches(frame);
  ASSERT_EQ(b.size(), 2u);
  expect_near(row(b.start, 0), {0.5, 5, 5});
  expect_near(row(b.arm, 0), {-0.95, 0, 0});  // centre minus contact point
  expect_near(row(b.force, 0), {1, 2, 3});
  expect_near(row(b.start, 1), {2.4, 5, 5});
  expect_near(row(b.arm, 1), {0.95, 0, 0});
  expect_near(row(b.force, 1), {-1, -2, -3});
}

TEST(HalfBranches, ContactPointInTheImageFrameOfTheFirst) {
  // Joined across x = 0: the point lies outside the box, a box length from the second grain.
  Frame frame = three_grains();
  add_contact(frame, 7, 20, {-4, 0, 0});
  add_point(frame, {-0.43, 5, 5});
  const HalfBranches b = half_branches(frame);
  expect_near(row(b.arm, 0), {0.93, 0, 0});
  expect_near(row(b.arm, 1), {-0.47, 0, 0});
}

TEST(HalfBranches, WithoutPointsTheRadiusWeightedPoint) {
  Frame frame = three_grains();
  add_contact(frame, 7, 20, {-4, 0, 0});
  add_contact(frame, 7, 31, {1, 2, 3});
  const HalfBranches b = half_branches(frame);
  ASSERT_EQ(b.size(), 4u);
  // l = x_1 - x_2 = 1.4 across the boundary, shared 2 : 1
  expect_near(row(b.arm, 0), {1.4 * 2 / 3, 0, 0});
  expect_near(row(b.arm, 1), {-1.4 / 3, 0, 0});
  expect_near(row(b.arm, 2), {-0.95, 0, 0});
  expect_near(row(b.arm, 3), {0.95, 0, 0});
}

TEST(HalfBranches, RadiiAreNotNeededWithPoints) {
  Frame frame = three_grains();
  frame.particles.radius.clear();
  add_contact(frame, 7, 31, {1, 2, 3});
  add_point(frame, {1.45, 5, 5});
  expect_near(row(half_branches(frame).arm, 1), {0.95, 0, 0});
}

TEST(HalfBranches, FindParticlesWhateverTheirIds) {
  // Dense ids with gaps, and ids far apart, negative ones among them.
  for (const std::int64_t step : {std::int64_t{1}, std::int64_t{3}, std::int64_t{1} << 60}) {
    Frame frame;
    frame.box = {{0, 0, 0}, {10, 10, 10}, {false, false, false}};
    for (int k = 0; k < 5; ++k) add_particle(frame, (k - 2) * step, {2.0 * k, 0, 0}, 1);
    for (int k = 0; k < 4; ++k) add_contact(frame, (k - 2) * step, (k - 1) * step, {1, 0, 0});
    const HalfBranches b = half_branches(frame);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(b.start[0][2 * k], 2.0 * static_cast<double>(k)) << step;
      EXPECT_EQ(b.start[0][2 * k + 1], 2.0 * static_cast<double>(k + 1)) << step;
    }
    if (step == 1) continue;
    add_contact(frame, 0, step - 1, {1, 0, 0});
    EXPECT_THAT(message(frame), testing::HasSubstr("found id " + std::to_string(step - 1)));
  }
}

TEST(HalfBranches, TheFirstContactInErrorIsReported) {
  Frame frame = three_grains();
  for (int k = 0; k < 20000; ++k) add_contact(frame, 7, k < 5000 ? 31 : 100000 + k, {1, 0, 0});
  for (int repeat = 0; repeat < 5; ++repeat) EXPECT_THAT(message(frame), testing::HasSubstr("found id 105000"));
}

TEST(HalfBranches, UnknownParticleIsNamed) {
  for (const auto& [id1, id2] : {std::pair{7, 8}, std::pair{6, 7}, std::pair{31, 32}}) {
    Frame frame = three_grains();
    add_contact(frame, id1, id2, {1, 0, 0});
    const std::string missing = id1 == 6 ? "id 6" : "id " + std::to_string(id2);
    EXPECT_THAT(message(frame), testing::AllOf(testing::StartsWith("dump.5: step 5: the contact between particles " +
                                                                   std::to_string(id1) + " and " + std::to_string(id2)),
                                               testing::HasSubstr("found " + missing)));
  }
}

TEST(HalfBranches, FarContactPointIsRefused) {
  Frame frame = three_grains();
  add_contact(frame, 7, 31, {1, 2, 3});
  add_point(frame, {0.5, 7.1, 5});
  EXPECT_THAT(message(frame),
              testing::HasSubstr("a distance of 2.1 from the centre of particle 7; expected at most 2"));
  frame.contacts.point[1][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message(frame), testing::HasSubstr("far outside"));
}

TEST(HalfBranches, FarGrainsAreRefusedWithoutPoints) {
  Frame frame = three_grains();
  add_contact(frame, 20, 31, {1, 2, 3});  // 3.3 apart
  frame.particles.position[1][1] = 7.5;
  EXPECT_THAT(message(frame), testing::HasSubstr("far outside"));
}

TEST(HalfBranches, SelfContactIsRefused) {
  Frame frame = three_grains();
  add_contact(frame, 7, 7, {1, 0, 0});
  EXPECT_THAT(message(frame), testing::HasSubstr("with itself"));
}

TEST(HalfBranches, NeitherPointsNorRadiiIsRefused) {
  Frame frame = three_grains();
  frame.particles.radius.clear();
  add_contact(frame, 7, 31, {1, 0, 0});
  EXPECT_THAT(message(frame), testing::HasSubstr("no contact point and the particles no radius"));
}

void add_wall_contact(Frame& frame, std::int64_t id, const Vec3& force, const Vec3& point) {
  frame.wall_contacts.id.push_back(id);
  for (std::size_t a = 0; a < 3; ++a) {
    frame.wall_contacts.force[a].push_back(force[a]);
    frame.wall_contacts.point[a].push_back(point[a]);
  }
}

TEST(WallHalfBranches, OnePerContactTowardsThePoint) {
  Frame frame = three_grains();
  EXPECT_EQ(wall_half_branches(frame).size(), 0u);
  add_wall_contact(frame, 7, {1, 2, 3}, {0.5, 5, 4.1});
  add_wall_contact(frame, 7, {4, 5, 6}, {9.6, 5, 5});  // across x = 0
  add_wall_contact(frame, 31, {7, 8, 9}, {2.4, 4, 5});
  const HalfBranches b = wall_half_branches(frame);
  ASSERT_EQ(b.size(), 3u);
  expect_near(row(b.start, 0), {0.5, 5, 5});
  expect_near(row(b.arm, 0), {0, 0, 0.9});  // centre minus contact point
  expect_near(row(b.force, 0), {1, 2, 3});
  expect_near(row(b.start, 1), {0.5, 5, 5});
  expect_near(row(b.arm, 1), {0.9, 0, 0});
  expect_near(row(b.start, 2), {2.4, 5, 5});
  expect_near(row(b.arm, 2), {0, 1, 0});
  expect_near(row(b.force, 2), {7, 8, 9});
  EXPECT_THAT(wall_branch_particles(frame), testing::ElementsAre(0, 0, 2));
}

TEST(WallHalfBranches, WhatDoesNotFitIsRefused) {
  const auto refusal = [](std::int64_t id, const Vec3& point) -> std::string {
    Frame frame = three_grains();
    add_wall_contact(frame, id, {1, 0, 0}, point);
    try {
      wall_half_branches(frame);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(refusal(8, {0.5, 5, 4}),
              testing::AllOf(testing::StartsWith("dump.5: step 5: the contact of a wall with particle 8 names"),
                             testing::HasSubstr("found id 8")));
  EXPECT_THAT(
      refusal(20, {0, 0, 0}),
      testing::AllOf(testing::StartsWith("dump.5: step 5: the contact point of a wall and particle 20 lies far"),
                     testing::HasSubstr("at most 1, two radii")));
  EXPECT_EQ(refusal(20, {9.1, 5, 4.01}), "no error");
}

}  // namespace
}  // namespace grainvdb::branches_test
