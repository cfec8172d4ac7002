#include "pipeline/frame_range.hpp"

#include <gtest/gtest.h>

namespace grainvdb::frame_range_test {
namespace {

using Frames = std::vector<std::size_t>;

Frames of_ten(const char* text) {
  const auto range = parse_frame_range(text);
  return range ? select_frames(*range, 10) : Frames{999};
}

// The right-hand sides are list(range(10))[...] of Python.
TEST(FrameRange, SlicesAsPythonDoes) {
  EXPECT_EQ(of_ten("::"), (Frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(of_ten(":"), (Frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(of_ten("::3"), (Frames{0, 3, 6, 9}));
  EXPECT_EQ(of_ten("2:5"), (Frames{2, 3, 4}));
  EXPECT_EQ(of_ten("7:"), (Frames{7, 8, 9}));
  EXPECT_EQ(of_ten("-3:"), (Frames{7, 8, 9}));
  EXPECT_EQ(of_ten(":-7"), (Frames{0, 1, 2}));
  EXPECT_EQ(of_ten("-5:-1:2"), (Frames{5, 7}));
  EXPECT_EQ(of_ten("-100:2"), (Frames{0, 1}));
  EXPECT_EQ(of_ten("8:100"), (Frames{8, 9}));
  EXPECT_EQ(of_ten("20:30"), (Frames{}));
  EXPECT_EQ(of_ten("5:2"), (Frames{}));
  EXPECT_EQ(of_ten("::1000000000000"), (Frames{0}));
}

TEST(FrameRange, OneNumberIsOneFrame) {
  EXPECT_EQ(of_ten("0"), (Frames{0}));
  EXPECT_EQ(of_ten("7"), (Frames{7}));
  EXPECT_EQ(of_ten("-1"), (Frames{9}));
  EXPECT_EQ(of_ten("-2"), (Frames{8}));
  EXPECT_EQ(of_ten("10"), (Frames{}));
}

TEST(FrameRange, SelectsNothingFromNothing) {
  EXPECT_TRUE(select_frames(FrameRange{}, 0).empty());
}

TEST(FrameRange, RefusesOtherTexts) {
  for (const char* text : {"", "a", "1:2:3:4", "::0", "::-1", "1.5", "1;2", " 1", "1 :2", "99999999999999", "all"})
    EXPECT_FALSE(parse_frame_range(text)) << text;
}

}  // namespace
}  // namespace grainvdb::frame_range_test
