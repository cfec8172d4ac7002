// Output times whose frames overlap, or that leave frames out: each is the mean that a run over its frames alone gives.
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::sliding_windows_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Means are summed in another order: a few roundings of double, which reach the float that is stored seldom and then
/// as one unit of its last place; a difference of two such, as the kinetic stress, can lose a few digits more.
void expect_same(const Written& found, const Written& expected) {
  EXPECT_EQ(found.time.first_step, expected.time.first_step);
  EXPECT_EQ(found.time.last_step, expected.time.last_step);
  EXPECT_EQ(found.time.frame_count, expected.time.frame_count);
  EXPECT_DOUBLE_EQ(found.time.time, expected.time.time);
  for (const auto& [name, field] : expected.fields) {
    const FieldCopy& other = found.field(name);
    ASSERT_EQ(other.topology->origins(), field.topology->origins()) << name;
    double largest = 0;
    for (float v : field.values)
      if (!std::isnan(v)) largest = std::max(largest, std::abs(static_cast<double>(v)));
    for (std::size_t i = 0; i < field.values.size(); ++i) {
      if (std::isnan(field.values[i])) {
        ASSERT_TRUE(std::isnan(other.values[i])) << name;
      } else {
        ASSERT_NEAR(other.values[i], field.values[i],
                    0x1p-23 * std::abs(static_cast<double>(field.values[i])) + 1e-13 * largest)
            << name;
      }
    }
  }
}

void expect_windows(Pipeline p, const std::vector<Frame>& frames, const std::vector<FrameRange>& windows) {
  const Result r = run(p, frames);
  ASSERT_EQ(r.record.times.size(), windows.size());
  p.window = p.window_step = 0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    SCOPED_TRACE(w);
    p.frames = windows[w];
    expect_same(r.record.times[w], run(p, frames).only());
  }
}

const std::vector<std::string> one_sweep{"phi", "velocity", "temperature", "contact_stress", "frames"};
const std::vector<std::string> two_sweeps{"phi", "velocity", "kinetic_stress", "frames"};

TEST(SlidingWindows, EqualTheMeansOverTheirFrames) {
  const Scene scene = moving(dilute_scene(), 9);
  for (const auto& fields : {one_sweep, two_sweeps}) {
    Pipeline p = scene.pipeline(fields);
    p.window = 4;
    p.window_step = 2;
    expect_windows(p, scene.frames, {{0, 4, 1}, {2, 6, 1}, {4, 8, 1}, {6, 9, 1}});
    p.window = 3;
    p.window_step = 1;
    p.frames.stop = 5;
    expect_windows(p, scene.frames, {{0, 3, 1}, {1, 4, 1}, {2, 5, 1}});
  }
}

TEST(SlidingWindows, SumEachFrameOnce) {
  const Scene scene = moving(dilute_scene(), 9);
  Pipeline p = scene.pipeline(one_sweep);
  p.input.contacts.files = {"memory"};
  p.window = 6;
  p.window_step = 1;
  MemorySource once(scene.frames);
  EXPECT_EQ(run(p, once).report.frames, 9U);
  EXPECT_EQ(once.counters().frames_read, 9U);
  // A second sweep is about the mean of its own window: nine frames for the first, six for each of the four windows.
  p.fields = two_sweeps;
  MemorySource again(scene.frames);
  run(p, again);
  EXPECT_EQ(again.counters().frames_read, 9U + 4 * 6);
}

TEST(Windows, LeaveFramesOut) {
  const Scene scene = moving(dilute_scene(), 9);
  Pipeline p = scene.pipeline(two_sweeps);
  p.window = 2;
  p.window_step = 4;
  expect_windows(p, scene.frames, {{0, 2, 1}, {4, 6, 1}, {8, 9, 1}});
  p.window = 1;
  p.window_step = 4;
  expect_windows(p, scene.frames, {{0, 1, 1}, {4, 5, 1}, {8, 9, 1}});
}

std::string provenance(const Result& r, const std::string& name) {
  for (const auto& [key, text] : r.record.provenance)
    if (key == name) return text;
  return "no " + name;
}

TEST(Windows, SayWhichFramesTheyAverage) {
  const Scene scene = moving(dilute_scene(), 9);
  Pipeline p = scene.pipeline({"phi"});
  p.window = 2;
  p.window_step = 4;
  const Result r = run(p, scene.frames);
  EXPECT_THAT(r.report.averaging, ElementsAre("3 output times of 2 frames, one every 4 frames; the last has only 1, "
                                              "fewer than average.window = 2"));
  EXPECT_EQ(provenance(r, "averaging"), r.report.averaging[0] + "\n");
  EXPECT_EQ(r.report.frames, 5U);
  EXPECT_THAT(provenance(r, "skipped_frames"), HasSubstr(std::to_string(scene.frames[2].step) + "\n"));
  EXPECT_EQ(provenance(r, "steps").find(std::to_string(scene.frames[2].step) + "\n"), std::string::npos);

  p.window_step = 0;
  p.frames.stop = 4;
  EXPECT_THAT(run(p, scene.frames).report.averaging, ElementsAre("2 output times of 2 frames"));
  p.window = 5;
  EXPECT_THAT(run(p, scene.frames).report.averaging,
              ElementsAre("1 output time of 4 frames, fewer than average.window = 5"));
}

// The sums that sliding windows share are bounded as all sums are: six frames of them are refused where one is not.
TEST(SlidingWindows, KeepWithinTheMemoryThatIsAllowed) {
  const Scene scene = moving(dilute_scene(), 9);
  Pipeline p = scene.pipeline({"phi", "velocity"});
  const double leaves = static_cast<double>(run(p, scene.frames).only().field("phi").topology->leaf_count());
  const double sums = leaves * 512 * 8 * 4;  // four channels
  p.limits.memory_gb = 4 * sums / 1e9;
  run(p, scene.frames);
  p.window = 6;
  p.window_step = 6;
  run(p, scene.frames);
  p.window_step = 1;
  EXPECT_THROW(run(p, scene.frames), LimitError);
}

}  // namespace
}  // namespace grainvdb::testing::sliding_windows_test
