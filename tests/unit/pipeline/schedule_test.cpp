#include "pipeline/schedule.hpp"

#include <numeric>

#include <gmock/gmock.h>

namespace grainvdb::schedule_test {
namespace {

std::vector<Visit> visits_of(const TimeWindows& windows, std::size_t frames, std::size_t sweeps) {
  std::vector<std::size_t> wanted(frames);
  std::iota(wanted.begin(), wanted.end(), std::size_t{0});
  return schedule_visits(schedule_windows(windows, frames), wanted, sweeps);
}

TEST(CertainVisits, AreTheSameWhateverFollows) {
  for (const std::size_t length : {0U, 1U, 2U, 3U, 4U, 6U})
    for (const std::size_t step : {0U, 1U, 2U, 3U, 4U, 8U})
      for (const std::size_t blocks : {1U, 2U, 3U})
        for (const std::size_t sweeps : {1U, 2U}) {
          if (length == 0 && step > 0) continue;
          const TimeWindows windows{length, step, blocks};
          for (std::size_t frames = 1; frames < 16; ++frames) {
            const std::size_t certain = certain_visits(windows, frames, sweeps);
            const std::vector<Visit> now = visits_of(windows, frames, sweeps);
            ASSERT_LE(certain, now.size());
            const bool overlapping = schedule_windows(windows, frames).overlapping;
            for (std::size_t all = frames + 1; all < frames + 20; ++all) {
              const std::vector<Visit> then = visits_of(windows, all, sweeps);
              ASSERT_GE(then.size(), certain);
              EXPECT_TRUE(std::equal(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(certain), then.begin()))
                  << length << ' ' << step << ' ' << blocks << ' ' << frames << ' ' << all;
              if (certain > 0) {
                EXPECT_EQ(schedule_windows(windows, all).overlapping, overlapping);
              }
            }
          }
        }
}

TEST(CertainVisits, AreMostOfThem) {
  EXPECT_EQ(certain_visits({}, 10, 2), 9U);          // one mean: all but the last frame of the first sweep
  EXPECT_EQ(certain_visits({4, 0, 1}, 10, 2), 17U);  // two windows twice, and a frame of the third
  EXPECT_EQ(certain_visits({1, 0, 1}, 10, 1), 10U);  // each frame by itself
  EXPECT_EQ(certain_visits({4, 2, 1}, 4, 1), 0U);    // whether windows will overlap is not known
  EXPECT_EQ(certain_visits({0, 0, 5}, 10, 1), 0U);   // nor how long blocks are
  EXPECT_EQ(certain_visits({5, 0, 5}, 13, 1), 10U);
}

}  // namespace
}  // namespace grainvdb::schedule_test
