#include "bin/mirror.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "bin/inside.hpp"

namespace grainvdb::mirror_test {
namespace {

Wall plane(const Vec3& point, const Vec3& normal) {
  return {Wall::Shape::plane, point, normal};
}

Particles at(const std::vector<Vec3>& places) {
  Particles p;
  for (const Vec3& x : places) {
    p.id.push_back(static_cast<std::int64_t>(p.id.size()) + 1);
    for (std::size_t a = 0; a < 3; ++a) p.position[a].push_back(x[a]);
    p.radius.push_back(0.5 + 0.1 * static_cast<double>(p.id.size()));
  }
  return p;
}

Vec3 row(const Columns3& columns, std::size_t n) {
  return {columns[0][n], columns[1][n], columns[2][n]};
}

std::vector<Vec3> places(const Particles& p) {
  std::vector<Vec3> all;
  for (std::size_t n = 0; n < p.size(); ++n) all.push_back(row(p.position, n));
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Mirror, ReflectsVectorsAndPseudoVectors) {
  Particles p = at({{1, 2, 3}});
  p.velocity = {{{4}, {5}, {6}}};
  p.angular_velocity = {{{7}, {8}, {9}}};
  p.type = {3};
  p.species = {1};
  Mirror({plane({0, 0, 1}, {0, 0, 1})}, 5).add_images(p);
  ASSERT_EQ(p.size(), 2U);
  EXPECT_EQ(row(p.position, 1), (Vec3{1, 2, -1}));
  EXPECT_EQ(row(p.velocity, 1), (Vec3{4, 5, -6}));
  EXPECT_EQ(row(p.angular_velocity, 1), (Vec3{-7, -8, 9}));
  EXPECT_EQ(p.id[1], 1);
  EXPECT_EQ(p.radius[1], p.radius[0]);
  EXPECT_EQ(p.type[1], 3);
  EXPECT_EQ(p.species, (std::vector<int>{1, 1}));
  EXPECT_TRUE(p.mass.empty());
}

// v = ω × r holds for the image of a rigid rotation about the image of its centre.
TEST(Mirror, TheImageOfARotationIsARotation) {
  const Vec3 spin{0.3, -1.1, 0.7};
  Particles p = at({{1, 2, 3}, {1.4, 1.7, 3.3}});
  p.angular_velocity = {{{spin[0], spin[0]}, {spin[1], spin[1]}, {spin[2], spin[2]}}};
  const Vec3 r{0.4, -0.3, 0.3};
  p.velocity = {{{0, spin[1] * r[2] - spin[2] * r[1]},
                 {0, spin[2] * r[0] - spin[0] * r[2]},
                 {0, spin[0] * r[1] - spin[1] * r[0]}}};
  Mirror({plane({0, 0, 0}, {0.6, 0, 0.8})}, 9).add_images(p);
  ASSERT_EQ(p.size(), 4U);
  const Vec3 w = row(p.angular_velocity, 2);
  Vec3 d;
  for (std::size_t a = 0; a < 3; ++a) d[a] = p.position[a][3] - p.position[a][2];
  const Vec3 v{w[1] * d[2] - w[2] * d[1], w[2] * d[0] - w[0] * d[2], w[0] * d[1] - w[1] * d[0]};
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(p.velocity[a][3], v[a], 1e-14);
}

TEST(Mirror, ImagesOnlyWhatIsNear) {
  Particles p = at({{0, 0, 0}, {0, 0, 1.9}, {0, 0, 2}});
  Mirror({plane({5, 5, 0}, {0, 0, 1})}, 2).add_images(p);
  EXPECT_EQ(p.id, (std::vector<std::int64_t>{1, 2, 3, 1, 2}));
}

TEST(Mirror, CornersHaveImagesOfImages) {
  Particles p = at({{1, 2, 3}});
  Mirror({plane({0, 0, 0}, {1, 0, 0}), plane({0, 0, 0}, {0, 1, 0}), plane({0, 0, 0}, {0, 0, 1})}, 4).add_images(p);
  std::vector<Vec3> expected;
  for (double x : {-1.0, 1.0})
    for (double y : {-2.0, 2.0})
      for (double z : {-3.0, 3.0}) expected.push_back({x, y, z});
  EXPECT_EQ(places(p), expected);
}

// Between planes at 0 and 1 a particle at 0.3 has images at ±0.3 + 2 n, as deep as asked for.
TEST(Mirror, PlanesThatFaceEachOtherReflectOnAndOn) {
  Particles p = at({{0, 0, 0.3}});
  Mirror({plane({0, 0, 0}, {0, 0, 1}), plane({0, 0, 1}, {0, 0, -1})}, 3.5).add_images(p);
  std::vector<double> found;
  for (const Vec3& x : places(p)) found.push_back(x[2]);
  std::vector<double> expected;
  for (int n = -3; n <= 3; ++n)
    for (double x : {-0.3, 0.3})
      if (2 * n + x > -3.5 && 2 * n + x < 4.5) expected.push_back(2 * n + x);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], expected[n], 1e-14);
}

TEST(Mirror, HalfBranchesThatReachNearHaveImages) {
  HalfBranches b;
  b.start = {{{0, 0, 0}, {0, 0, 0}, {2.4, 2.6, -0.2}}};
  b.arm = {{{0, 0.1, 0}, {0, 0, 0}, {0.5, 0.5, -0.5}}};
  b.force = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
  Mirror({plane({0, 0, 0}, {0, 0, 1})}, 2).add_images(b);  // the contact point of the second lies at 2.1
  ASSERT_EQ(b.size(), 5U);
  EXPECT_EQ(row(b.start, 3), (Vec3{0, 0, -2.4}));
  EXPECT_EQ(row(b.arm, 3), (Vec3{0, 0, -0.5}));
  EXPECT_EQ(row(b.force, 3), (Vec3{1, 4, -7}));
  EXPECT_EQ(row(b.start, 4), (Vec3{0, 0, 0.2}));
}

TEST(Inside, LeavesOutWhatHasItsCentreBehind) {
  const WallDomain domain({plane({0, 0, 0}, {0, 0, 1}), plane({0, 0, 9}, {0, 0, -2})});
  Particles p = at({{0, 0, -0.1}, {0, 0, 0}, {0, 0, 9}, {0, 0, 9.1}, {5, 5, 5}});
  p.velocity = p.position;
  p.species = {0, 1, 0, 1, -1};
  keep_inside(domain, p);
  EXPECT_EQ(p.id, (std::vector<std::int64_t>{2, 3, 5}));
  EXPECT_EQ(p.velocity[2], (std::vector<double>{0, 9, 5}));
  EXPECT_EQ(p.radius.size(), 3U);
  EXPECT_EQ(p.species, (std::vector<int>{1, 0, -1}));
  EXPECT_TRUE(p.mass.empty());
}

TEST(Inside, BothHalvesOfAContactStayTogether) {
  HalfBranches b;
  b.start = {{{0, 1, 2, 3}, {0, 0, 0, 0}, {-1, 5, 5, 5}}};
  b.arm = b.force = {{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
  keep_inside(WallDomain({plane({0, 0, 0}, {0, 0, 1})}), b);
  EXPECT_EQ(b.start[0], (std::vector<double>{2, 3, 1}));
}

}  // namespace
}  // namespace grainvdb::mirror_test
