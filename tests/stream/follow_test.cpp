// What a run that follows its input does while nothing interrupts it.
#include "grainvdb/follow.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/same_fields.hpp"
#include "support/dump_text.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::follow_test {
namespace {

constexpr int frame_count = 6;

std::string dump(int step) {
  std::string text = "ITEM: TIMESTEP\n" + std::to_string(step) +
                     "\nITEM: NUMBER OF ATOMS\n8\nITEM: BOX BOUNDS pp pp pp\n0 2\n0 2\n0 2\n"
                     "ITEM: ATOMS id x y z vx vy vz radius mass\n";
  for (int i = 0; i < 8; ++i)
    text += std::to_string(i + 1) + (i & 4 ? " 1.5" : " 0.5") + (i & 2 ? " 1.5" : " 0.5") +
            (i & 1 ? " 1.5 " : " 0.5 ") + std::to_string(step) + " 0 0 0.5 1\n";
  return text;
}

// Each look goes on where the one before ended: no frame is summed twice.
TEST(Follow, SumsEachFrameOnceInEachSweep) {
  for (const std::size_t window : {0U, 2U}) {
    const TemporaryFolder folder;
    Pipeline p = make_pipeline(0.5, {0, 0, 0}, 1, {"phi", "velocity", "kinetic_stress"});
    p.input.particles = {folder.path() + "/dump*"};
    p.input.dt = 1;
    p.window = window;
    const Plan plan = make_plan(p);
    ASSERT_EQ(plan.sweeps.size(), 2U);
    int written = 0;
    std::size_t summed = 0, waits_after_sums = 0;
    const auto progress = [&](const Progress& now) {
      if (now.doing != "waiting for frames") {
        ++summed;
        return;
      }
      if (summed > 0) ++waits_after_sums;
      if (written == frame_count) return;
      write_plain(folder.path() + "/dump" + std::to_string(written), dump(written));
      ++written;
    };
    const auto record = std::make_shared<Record>();
    std::vector<std::unique_ptr<FieldSink>> sinks;
    sinks.push_back(std::make_unique<MemorySink>(record));
    FollowedInput input(p.input);
    FollowOptions waiting;
    waiting.last_step = frame_count - 1;
    waiting.interval = 0.01;
    const RunReport report = follow_pipeline(p, plan, input, sinks, {}, waiting, {folder.path() + "/output"}, progress);
    EXPECT_EQ(summed, 2U * frame_count);
    EXPECT_GT(waits_after_sums, 1U);
    EXPECT_EQ(report.frames, std::size_t{frame_count});
    EXPECT_EQ(report.resumed_at, 0U);
    const auto dumps = open_dumps(p.input);
    expect_same_fields(*record, run(p, *dumps).record);
  }
}

struct Interruption {};

// The input ends, a second sweep over it begins and is interrupted, and then there are more frames after all: what was
// summed in that sweep is about the mean of too few.
TEST(Follow, BeginsAnewWhereWhatItSavedIsNoneOfMoreFrames) {
  const TemporaryFolder folder;
  Pipeline p = make_pipeline(0.5, {0, 0, 0}, 1, {"phi", "velocity", "kinetic_stress"});
  p.input.particles = {folder.path() + "/dump*"};
  p.input.dt = 1;
  const Plan plan = make_plan(p);
  ASSERT_EQ(plan.sweeps.size(), 2U);
  const auto follow = [&](const std::function<void(const Progress&)>& progress) {
    const auto record = std::make_shared<Record>();
    std::vector<std::unique_ptr<FieldSink>> sinks;
    sinks.push_back(std::make_unique<MemorySink>(record));
    FollowedInput input(p.input);
    FollowOptions waiting;
    waiting.timeout = 0;
    follow_pipeline(p, plan, input, sinks, {}, waiting, {folder.path() + "/output"}, progress);
    return record;
  };
  for (int step = 0; step < 4; ++step) write_plain(folder.path() + "/dump" + std::to_string(step), dump(step));
  EXPECT_THROW(follow([](const Progress& now) {
                 if (now.doing == "sweep 2 of 2" && now.frames_done == 6) throw Interruption();
               }),
               Interruption);
  for (int step = 4; step < 6; ++step) write_plain(folder.path() + "/dump" + std::to_string(step), dump(step));
  const auto dumps = open_dumps(p.input);
  expect_same_fields(*follow({}), run(p, *dumps).record);
}

}  // namespace
}  // namespace grainvdb::testing::follow_test
