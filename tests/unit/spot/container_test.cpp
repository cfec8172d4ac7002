#include "spot/container.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace grainvdb::spot::container_test {
namespace {

Container silo(Orifice::Shape shape) {
  return {{{-10, -4, 0}, {10, 4, 30}, {false, true, false}}, Orifice{shape, {0, 0}, 6}};
}

void expect_push(const Container& container, const Vec3& x, const Vec3& expected) {
  const Vec3 push = push_from_walls(container, x, 1);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(push[a], expected[a], 1e-14) << a;
}

TEST(Container, WallsAndFloorPushOut) {
  const Container c = silo(Orifice::Shape::slot);
  expect_push(c, {5, 0, 10}, {0, 0, 0});
  expect_push(c, {9.8, 3.9, 10}, {-0.3, 0, 0});
  expect_push(c, {-9.9, 0, 0.3}, {0.4, 0, 0.2});
  expect_push(c, {0, 0, 0.1}, {0, 0, 0});  // over the hole
  expect_push({c.box, std::nullopt}, {0, 0, 0.1}, {0, 0, 0.4});
}

TEST(Container, TheRimPushesAwayFromItself) {
  // 0.3 from the rim along x, 0.4 above: it is 0.5 away and just touches; nearer it is pushed along the line between.
  expect_push(silo(Orifice::Shape::slot), {2.7, 0, 0.4}, {0, 0, 0});
  expect_push(silo(Orifice::Shape::slot), {2.85, 0, 0.2}, {-0.25 * 0.6, 0, 0.25 * 0.8});
  const double s = std::sqrt(0.5);
  expect_push(silo(Orifice::Shape::circle), {2.85 * s, 2.85 * s, -0.2},
              {-0.25 * 0.6 * s, -0.25 * 0.6 * s, -0.25 * 0.8});
}

TEST(Container, ThePlateHasALowerSideToo) {
  expect_push(silo(Orifice::Shape::slot), {4, 0, -0.2}, {0, 0, -0.3});
  expect_push(silo(Orifice::Shape::slot), {4, 0, -0.7}, {0, 0, 0});
}

}  // namespace
}  // namespace grainvdb::spot::container_test
