// Several scales in one pass give what each gives by itself.
#include "grainvdb/scales.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "grainvdb/memory_model.hpp"
#include "stream/same_fields.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::scales_test {
namespace {

/// Counts what is read, and fails at a frame.
class CountingSource : public MemorySource {
 public:
  using MemorySource::MemorySource;
  Frame read(std::size_t k, ColumnSet wanted) override {
    ++reads;
    if (static_cast<std::int64_t>(k) == bad) throw InputError({{"frame", 3}, "a bad row", {}, {}, {}});
    return MemorySource::read(k, wanted);
  }
  std::size_t reads = 0;
  std::int64_t bad = -1;
};

class Scales : public ::testing::Test {
 protected:
  Scales() {
    pipeline_.input.contacts.files = {"memory"};
    for (const double factor : {1.0, 1.2, 1.4})
      pipeline_.scales.push_back({factor * pipeline_.cutoff, pipeline_.voxel, std::to_string(factor)});
    for (int k = 0; k < 6; ++k) {
      Frame frame = scene_.frames[static_cast<std::size_t>(k) % scene_.frames.size()];
      frame.step = k;
      frame.time = k;
      frames_.push_back(std::move(frame));
    }
  }

  std::vector<ScaleRun> runs(std::vector<std::shared_ptr<Record>>& records) const {
    std::vector<ScaleRun> all;
    for (Pipeline& p : at_scales(pipeline_)) {
      ScaleRun& run = all.emplace_back();
      run.plan = make_plan(p);
      records.push_back(std::make_shared<Record>());
      run.sinks.push_back(std::make_unique<MemorySink>(records.back()));
      run.pipeline = std::move(p);
    }
    return all;
  }

  Scene scene_ = walled_scene();
  Pipeline pipeline_ = scene_.pipeline({"phi", "velocity", "temperature", "stress", "mu"});
  std::vector<Frame> frames_;
};

TEST_F(Scales, GiveWhatEachGivesAndReadFramesOnce) {
  for (const std::size_t window : {0U, 2U}) {
    pipeline_.window = window;
    CountingSource source(frames_);
    std::vector<std::shared_ptr<Record>> records;
    auto all = runs(records);
    const std::vector<RunReport> reports = run_scales(all, source);
    EXPECT_EQ(source.reads, 2 * frames_.size());  // two sweeps
    ASSERT_EQ(reports.size(), 3U);
    for (std::size_t n = 0; n < all.size(); ++n) {
      MemorySource alone(frames_);
      const Result expected = run(all[n].pipeline, alone);
      expect_same_fields(*records[n], expected.record);
      EXPECT_EQ(records[n]->provenance, expected.record.provenance);
      EXPECT_EQ(reports[n].active_voxels, expected.report.active_voxels);
    }
  }
}

TEST_F(Scales, StateTheMemoryOfAll) {
  pipeline_.limits.frames_in_flight = 2;
  std::vector<std::shared_ptr<Record>> records;
  auto all = runs(records);
  std::size_t particles = 0, contacts = 0;
  for (const Frame& frame : frames_) {
    particles = std::max(particles, frame.particles.size());
    contacts = std::max(contacts, frame.contacts.size());
  }
  double expected = memory_model(all[0].plan, all[0].pipeline)
                        .more_than_sum(3, static_cast<double>(particles), static_cast<double>(contacts));
  for (const ScaleRun& one : all) {
    MemorySource alone(frames_);
    expected += run(one.pipeline, alone).report.memory;
  }
  MemorySource source(frames_);
  for (const RunReport& report : run_scales(all, source)) EXPECT_DOUBLE_EQ(report.memory, expected);
}

TEST_F(Scales, LeaveBadFramesOutOfAll) {
  pipeline_.input.on_error = OnError::skip_frame;
  CountingSource source(frames_);
  source.bad = 2;
  std::vector<std::shared_ptr<Record>> records;
  auto all = runs(records);
  for (const RunReport& report : run_scales(all, source)) EXPECT_EQ(report.bad_frames.size(), 1U);
}

TEST_F(Scales, EndTogetherWhenOneFails) {
  CountingSource source(frames_);
  source.bad = 4;
  std::vector<std::shared_ptr<Record>> records;
  auto all = runs(records);
  EXPECT_THROW(run_scales(all, source), InputError);
  for (const auto& record : records) EXPECT_FALSE(record->committed);
}

TEST_F(Scales, EndWhenTheCallerWants) {
  struct Enough {};
  CountingSource source(frames_);
  std::vector<std::shared_ptr<Record>> records;
  auto all = runs(records);
  std::size_t shown = 0;
  EXPECT_THROW(run_scales(all, source,
                          [&](const Progress&) {
                            if (++shown == 5) throw Enough();
                          }),
               Enough);
}

}  // namespace
}  // namespace grainvdb::testing::scales_test
