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

// 2.6 from the rim at x = 3: at the height of the floor that leaves 0.4, 1 above or below it 3 - 2.4.
TEST(Container, RoomOverTheOrificeGrowsWithTheDistanceFromTheFloor) {
  const Container c = silo(Orifice::Shape::slot);
  EXPECT_NEAR(room_over_orifice(c, 0, 2.6), 0.4, 1e-14);
  EXPECT_NEAR(room_over_orifice(c, 1, 2.6), 0.6, 1e-14);
  EXPECT_NEAR(room_over_orifice(c, -1, 2.6), 0.6, 1e-14);
  EXPECT_EQ(room_over_orifice(c, 0, 4), 0);
  EXPECT_TRUE(std::isinf(room_over_orifice(c, 2.6, 2.6)));
  EXPECT_TRUE(std::isinf(room_over_orifice(c, 0, 0)));
  EXPECT_TRUE(std::isinf(room_over_orifice({c.box, std::nullopt}, 0, 2.6)));
}

TEST(Container, StepsAreCutShortOfThePlate) {
  const Container slot = silo(Orifice::Shape::slot), circle = silo(Orifice::Shape::circle);
  const auto expect_step = [](const Vec3& step, const Vec3& expected) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(step[a], expected[a], 1e-14) << a;
  };
  // It ends 1 above the floor, where there is room for 0.6.
  expect_step(kept_off_plate(slot, {0.3, 5, 0.9}, {0.7, 0.7, 0.1}, 2.6), {0.3, 0.7, 0.1});
  expect_step(kept_off_plate(slot, {-0.3, 5, 0.9}, {-0.7, 0.7, 0.1}, 2.6), {-0.3, 0.7, 0.1});
  expect_step(kept_off_plate(slot, {0.3, 5, 0.9}, {-0.7, 0.7, 0.1}, 2.6), {-0.7, 0.7, 0.1});
  // In a circle towards its middle: (0.6, 0.8) is 1 away from it.
  expect_step(kept_off_plate(circle, {0.3, 0.4, 0.9}, {0.3, 0.4, 0.1}, 2.6), {0.06, 0.08, 0.1});
  // Where there is no room at all it is the middle; below the floor the room gets narrower on the way up.
  expect_step(kept_off_plate(slot, {0, 0, 0}, {0.7, 0, 0.1}, 4), {0, 0, 0.1});
  expect_step(kept_off_plate(slot, {0.6, 0, -1}, {0.7, 0, 1}, 2.6), {-0.2, 0, 1});
  // High enough, or already over the plate, it goes where it likes.
  expect_step(kept_off_plate(slot, {5, 0, 2.55}, {0.7, 0, 0.1}, 2.6), {0.7, 0, 0.1});
  expect_step(kept_off_plate(slot, {5, 0, 1}, {0.7, 0, 0.1}, 2.6), {0.7, 0, 0.1});
  expect_step(kept_off_plate(slot, {2, 0, 0}, {0.7, 0, 0.1}, 0), {0.7, 0, 0.1});
}

}  // namespace
}  // namespace grainvdb::spot::container_test
