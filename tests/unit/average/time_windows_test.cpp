#include "average/time_windows.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "average/growing_blocks.hpp"

namespace grainvdb::time_windows_test {
namespace {

using ::testing::ElementsAre;

std::vector<std::pair<std::size_t, std::size_t>> spans(const WindowSchedule& schedule) {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (const Window& w : schedule.windows) all.emplace_back(w.frames.first, w.frames.count);
  return all;
}
std::vector<std::size_t> part_sizes(const WindowSchedule& schedule) {
  std::vector<std::size_t> all;
  for (const FrameSpan& p : schedule.parts) all.push_back(p.count);
  return all;
}
using Pairs = std::pair<std::size_t, std::size_t>;

TEST(TimeWindows, AllFramesInOne) {
  const WindowSchedule s = schedule_windows({}, 7);
  EXPECT_THAT(spans(s), ElementsAre(Pairs{0, 7}));
  EXPECT_THAT(part_sizes(s), ElementsAre(7));
  EXPECT_FALSE(s.overlapping);
}

TEST(TimeWindows, OneAfterAnotherTheLastShorter) {
  const WindowSchedule s = schedule_windows({3, 0, 1}, 7);
  EXPECT_THAT(spans(s), ElementsAre(Pairs{0, 3}, Pairs{3, 3}, Pairs{6, 1}));
  EXPECT_FALSE(s.overlapping);
  EXPECT_THAT(spans(schedule_windows({10, 0, 1}, 7)), ElementsAre(Pairs{0, 7}));
}

TEST(TimeWindows, FramesLeftOutInBetween) {
  const WindowSchedule s = schedule_windows({2, 5, 1}, 12);
  EXPECT_THAT(spans(s), ElementsAre(Pairs{0, 2}, Pairs{5, 2}, Pairs{10, 2}));
  EXPECT_EQ(s.frame_count(), 6U);
  EXPECT_THAT(spans(schedule_windows({1, 4, 1}, 9)), ElementsAre(Pairs{0, 1}, Pairs{4, 1}, Pairs{8, 1}));
}

TEST(TimeWindows, SlidingOnesShareTheirParts) {
  const WindowSchedule s = schedule_windows({6, 4, 1}, 14);
  EXPECT_TRUE(s.overlapping);
  EXPECT_THAT(spans(s), ElementsAre(Pairs{0, 6}, Pairs{4, 6}, Pairs{8, 6}));
  EXPECT_THAT(part_sizes(s), ElementsAre(2, 2, 2, 2, 2, 2, 2));
  EXPECT_EQ(s.windows[1].first_part, 2U);
  EXPECT_EQ(s.windows[1].part_count(), 3U);
  EXPECT_EQ(s.most_parts(), 3U);
  EXPECT_EQ(shared_parts({6, 4, 1}), 3U);
}

// The last window is shorter, and no window follows one that has reached the last frame.
TEST(TimeWindows, SlidingOnesEnd) {
  const WindowSchedule s = schedule_windows({5, 3, 1}, 12);
  EXPECT_THAT(spans(s), ElementsAre(Pairs{0, 5}, Pairs{3, 5}, Pairs{6, 5}, Pairs{9, 3}));
  EXPECT_THAT(spans(schedule_windows({5, 1, 1}, 7)), ElementsAre(Pairs{0, 5}, Pairs{1, 5}, Pairs{2, 5}));
  EXPECT_FALSE(schedule_windows({5, 1, 1}, 4).overlapping);
}

TEST(TimeWindows, BlocksOfNearlyEqualLength) {
  const WindowSchedule s = schedule_windows({0, 0, 4}, 10);
  EXPECT_THAT(part_sizes(s), ElementsAre(2, 3, 2, 3));
  EXPECT_THAT(s.windows[0].blocks, ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(part_sizes(schedule_windows({0, 0, 8}, 3)), ElementsAre(1, 1, 1));
  EXPECT_THAT(part_sizes(schedule_windows({4, 0, 2}, 7)), ElementsAre(2, 2, 1, 2));
}

// Ten frames every five share parts of five; four blocks want shorter ones.
TEST(TimeWindows, BlocksOfSlidingWindows) {
  const WindowSchedule s = schedule_windows({10, 5, 4}, 20);
  EXPECT_THAT(part_sizes(s), ElementsAre(2, 3, 2, 3, 2, 3, 2, 3));
  for (const Window& w : s.windows) EXPECT_THAT(w.blocks, ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(schedule_windows({7, 1, 3}, 9).windows[0].blocks, ElementsAre(2, 2, 3));
}

TEST(GrowingBlocks, AreBetweenTheFewestAndTwiceAsMany) {
  for (const std::size_t fewest : {2U, 3U, 10U})
    for (std::size_t frames = 1; frames < 300; ++frames) {
      const std::size_t length = growing_block_length(fewest, frames);
      EXPECT_LE(frames, 2 * fewest * length);
      EXPECT_GE(frames / length, std::min(frames, fewest));
      // Where it grows all blocks are full, and an even number.
      const std::size_t next = growing_block_length(fewest, frames + 1);
      if (next != length) {
        EXPECT_EQ(next, 2 * length);
        EXPECT_EQ(frames, 2 * fewest * length);
      }
    }
}

// Whatever is asked for: parts do not overlap, windows are made of whole parts, and at most one is short.
TEST(TimeWindows, PartsMakeUpTheWindows) {
  for (std::size_t frames = 1; frames < 14; ++frames)
    for (std::size_t length = 0; length < 8; ++length)
      for (std::size_t step = 0; step < (length == 0 ? 1 : 9); ++step)
        for (std::size_t blocks = 1; blocks < 5; ++blocks) {
          const WindowSchedule s = schedule_windows({length, step, blocks}, frames);
          if (s.overlapping) {
            ASSERT_EQ(s.most_parts(), shared_parts({length, step, blocks}));
          }
          for (std::size_t p = 1; p < s.parts.size(); ++p) ASSERT_GE(s.parts[p].first, s.parts[p - 1].end());
          for (std::size_t w = 0; w < s.windows.size(); ++w) {
            const Window& window = s.windows[w];
            const FrameSpan& first = s.parts.at(window.first_part);
            const FrameSpan& last = s.parts.at(window.first_part + window.part_count() - 1);
            ASSERT_EQ(first.first, window.frames.first);
            ASSERT_EQ(last.end(), window.frames.end());
            const bool full = window.frames.count == length;
            ASSERT_TRUE(full || w + 1 == s.windows.size());
            ASSERT_LE(window.blocks.size(), std::min(blocks, window.frames.count));
            // The parts of a last sliding window can be fewer.
            ASSERT_TRUE(window.blocks.size() == std::min(blocks, window.frames.count) || (s.overlapping && !full));
          }
        }
}

}  // namespace
}  // namespace grainvdb::time_windows_test
