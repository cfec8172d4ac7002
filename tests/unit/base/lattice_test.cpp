#include "grainvdb/lattice.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainvdb::lattice_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Lattice, VoxelCentresLieHalfAVoxelFromTheOrigin) {
  const Lattice lattice(0.5, {1, -2, 0});
  EXPECT_EQ(lattice.centre(0, 0), 1.25);
  EXPECT_EQ(lattice.centre(1, -3), -3.25);
  EXPECT_EQ(lattice.centre(Coord{1, 2, 3}), (Vec3{1.75, -0.75, 1.75}));
  EXPECT_EQ(lattice.to_index(0, 1.25), 0);
  EXPECT_EQ(lattice.to_index(1, -3.25), -3);
  EXPECT_EQ(lattice.to_index(2, 0), -0.5);
}

TEST(Lattice, WithoutPeriodsNothingWraps) {
  const Lattice lattice(1, {0, 0, 0});
  EXPECT_FALSE(lattice.period(0));
  EXPECT_EQ(lattice.wrap(0, -17), -17);
  EXPECT_EQ(lattice.wrap_index(0, 1e6), 1e6);
  EXPECT_TRUE(lattice.contains(0, -1000000));
}

TEST(Lattice, PeriodHoldsTheVoxelsWhoseCentresAreInTheBox) {
  Lattice lattice(0.5, {0.1, 0, 0});
  lattice.set_periods({{-2, 0, 0}, {3, 1, 1}, {true, false, true}});
  ASSERT_TRUE(lattice.period(0));
  EXPECT_FALSE(lattice.period(1));
  EXPECT_EQ(lattice.period(0)->count, 10);
  EXPECT_DOUBLE_EQ(lattice.period(0)->length, 10);
  EXPECT_EQ(lattice.period(0)->first, -4);  // centre -1.65; the one before, -2.15, lies outside
  EXPECT_EQ(lattice.period(2)->first, 0);
  EXPECT_EQ(lattice.period(2)->count, 2);
}

TEST(Lattice, RoundingDoesNotMoveTheFirstVoxel) {
  // lo lies on a voxel centre up to rounding: 0.35 = (3 + ½) 0.1.
  Lattice lattice(0.1, {0, 0, 0});
  for (double hair : {-1e-12, 0.0, 1e-12}) {
    lattice.set_periods({{0.35 + hair, 0, 0}, {1.35 + hair, 1, 1}, {true, false, false}});
    EXPECT_EQ(lattice.period(0)->first, 3) << hair;
    EXPECT_EQ(lattice.period(0)->count, 10);
  }
}

TEST(Lattice, VoxelsWrapIntoThePeriod) {
  Lattice lattice(1, {0, 0, 0});
  lattice.set_periods({{-3, 0, 0}, {4, 1, 1}, {true, false, false}});
  for (std::int32_t i = -50; i < 50; ++i) {
    const std::int32_t w = lattice.wrap(0, i);
    EXPECT_TRUE(lattice.contains(0, w));
    EXPECT_EQ((w - i) % 7, 0);
    EXPECT_EQ(lattice.contains(0, i), i >= -3 && i < 4);
  }
  EXPECT_EQ(lattice.wrap(Coord{4, 4, 4}), (Coord{-3, 4, 4}));
}

TEST(Lattice, IndexPositionsWrapIntoThePeriod) {
  Lattice lattice(1, {0, 0, 0});
  lattice.set_periods({{-3, 0, 0}, {4, 1, 1}, {true, false, false}});
  EXPECT_EQ(lattice.wrap_index(0, -3.5), -3.5);
  EXPECT_EQ(lattice.wrap_index(0, 3.5), -3.5);
  EXPECT_EQ(lattice.wrap_index(0, 3.25), 3.25);
  EXPECT_EQ(lattice.wrap_index(0, 0.25 + 7 * 1000), 0.25);
  EXPECT_EQ(lattice.wrap_index(0, 0.25 - 7 * 1000), 0.25);
  const double below = lattice.wrap_index(0, std::nextafter(-3.5, -4.0));
  EXPECT_GE(below, -3.5);
  EXPECT_LT(below, 3.5);
  EXPECT_TRUE(std::isnan(lattice.wrap_index(0, nan)));
  EXPECT_TRUE(std::isnan(lattice.wrap_index(0, std::numeric_limits<double>::infinity())));
}

TEST(Lattice, UnwrappedPositionsRepeatByTheLengthOfTheBox) {
  // A box of 100 voxels less a relative 5e-7: a thousand periods away that adds up to 0.05 voxels.
  const double length = 100 * (1 - 5e-7);
  Lattice lattice(1, {0, 0, 0});
  lattice.set_periods({{0, 0, 0}, {length, 1, 1}, {true, false, false}});
  EXPECT_NEAR(lattice.wrap_index(0, lattice.to_index(0, 20 + 1000 * length)), 19.5, 1e-9);
}

TEST(Lattice, RefusesPeriodsThatAreNotWholeVoxelsAndNamesTheNearest) {
  Lattice lattice(0.3, {0, 0, 0});
  try {
    lattice.set_periods({{0, 0, 0}, {1, 1, 1}, {false, true, false}});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("along y"), testing::HasSubstr("0.25"),
                                         testing::HasSubstr("0.333333333")));
  }
  EXPECT_NO_THROW(lattice.set_periods({{0, 0, 0}, {1, 0.9 * (1 + 5e-7), 1}, {false, true, false}}));
  EXPECT_THROW(lattice.set_periods({{0, 0, 0}, {1, 0.9 * (1 + 2e-6), 1}, {false, true, false}}), std::invalid_argument);
  EXPECT_THROW(lattice.set_periods({{0, 0, 0}, {1, 0.1, 1}, {false, true, false}}), std::invalid_argument);
}

TEST(Lattice, RefusesPeriodsThatCannotBeIndexed) {
  Lattice lattice(1, {0, 0, 0});
  EXPECT_THROW(lattice.set_periods({{0, 0, 0}, {4e9, 1, 1}, {true, false, false}}), std::invalid_argument);
  EXPECT_THROW(lattice.set_periods({{4e9, 0, 0}, {4e9 + 16, 1, 1}, {true, false, false}}), std::invalid_argument);
}

TEST(Lattice, HasTheSameVoxelsInAnotherUnit) {
  Lattice lattice(0.5, {-1, 0.25, 3});
  lattice.set_periods({{0, 0, 0}, {4, 1, 1}, {true, false, false}});
  const Lattice other = lattice.in_unit(0.25);
  EXPECT_EQ(other.voxel(), 2);
  EXPECT_EQ(other.origin(), (Vec3{-4, 1, 12}));
  EXPECT_EQ(other.centre(2, -3), lattice.centre(2, -3) / 0.25);
  ASSERT_TRUE(other.period(0));
  EXPECT_EQ(other.period(0)->first, lattice.period(0)->first);
  EXPECT_EQ(other.period(0)->count, 8);
  EXPECT_FALSE(other.period(1));
}

TEST(Lattice, RefusesVoxelsThatAreNotPositiveAndFinite) {
  for (double h : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(Lattice(h, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(Lattice(1, {0, nan, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::lattice_test
