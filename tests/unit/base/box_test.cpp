#include "grainvdb/box.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainvdb::box_test {
namespace {

const Box box{{-1, 2, 0}, {3, 4.5, 1}, {true, false, true}};

TEST(Box, WrapsIntoTheHalfOpenPeriod) {
  EXPECT_EQ(box.wrap(0, -1), -1);
  EXPECT_EQ(box.wrap(0, 3), -1);
  EXPECT_EQ(box.wrap(0, 3.5), -0.5);
  EXPECT_EQ(box.wrap(0, -1.5), 2.5);
  EXPECT_EQ(box.wrap(0, 1 + 4 * 1000), 1);
  EXPECT_EQ(box.wrap(0, 1 - 4 * 1000), 1);
}

TEST(Box, WrapStaysInsideWhenRoundingWouldLeave) {
  const double below = std::nextafter(0.0, -1.0);  // + length rounds to the length
  const double wrapped = box.wrap(2, below);
  EXPECT_GE(wrapped, 0);
  EXPECT_LT(wrapped, 1);
  const double last = std::nextafter(1.0, 0.0);
  EXPECT_EQ(box.wrap(2, last), last);
}

TEST(Box, LeavesOpenAxesAlone) {
  EXPECT_EQ(box.wrap(1, 100), 100);
  EXPECT_EQ(box.minimum_image(1, 100), 100);
}

TEST(Box, MinimumImageIsAtMostHalfALength) {
  EXPECT_EQ(box.minimum_image(0, 3), -1);
  EXPECT_EQ(box.minimum_image(0, -3), 1);
  EXPECT_EQ(box.minimum_image(0, 1.5), 1.5);
  EXPECT_EQ(box.minimum_image(0, 4 * 7 + 1), 1);
  EXPECT_EQ(std::abs(box.minimum_image(0, 2)), 2);
  for (int k = -40; k <= 40; ++k) EXPECT_LE(std::abs(box.minimum_image(2, 0.1 * k)), 0.5 + 1e-15);
}

TEST(Box, HasLengths) {
  EXPECT_EQ(box.length(0), 4);
  EXPECT_EQ(box.length(1), 2.5);
}

}  // namespace
}  // namespace grainvdb::box_test
