// A run that is interrupted anywhere and goes on gives what it would have given at once.
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "grainvdb/run.hpp"
#include "stream/same_fields.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::resume_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "grainvdb_resume_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Eight frames of two kinds in turn, one of them bad.
std::vector<Frame> frames_of(const Scene& scene) {
  std::vector<Frame> frames;
  for (int k = 0; k < 8; ++k) {
    Frame frame = scene.frames[static_cast<std::size_t>(k) % scene.frames.size()];
    frame.step = 10 * k;
    frame.time = 0.1 * k;
    if (k == 4) frame.contacts.id1[0] = 987654321;  // no such particle
    frames.push_back(std::move(frame));
  }
  return frames;
}

struct Interruption {};

class Resume : public ::testing::Test {
 protected:
  Resume() {
    pipeline_.input.contacts.files = {"memory"};
    pipeline_.input.on_error = OnError::skip_frame;
    pipeline_.resolved = "fields: some\nwindow: some\n";
  }

  /// Runs until so many frames are done; to the end without.
  std::optional<RunReport> run_until(std::optional<std::size_t> frames, Record* record = nullptr,
                                     double interval = 1e9) {
    MemorySource source(frames_);
    const auto to = std::make_shared<Record>();
    std::vector<std::unique_ptr<FieldSink>> sinks;
    sinks.push_back(std::make_unique<MemorySink>(to));
    const auto progress = [&](const Progress& now) {
      if (frames && now.frames_done == *frames) throw Interruption();
    };
    try {
      const RunReport report = run_pipeline(pipeline_, make_plan(pipeline_), source, sinks, progress,
                                            CheckpointOptions{folder_.path(), interval});
      if (record != nullptr) *record = *to;
      return report;
    } catch (const Interruption&) {
      return std::nullopt;
    }
  }

  void expect_the_same_wherever_it_is_interrupted() {
    MemorySource source(frames_);
    const Result whole = run(pipeline_, source);
    bool ended = false;
    for (std::size_t at = 1; !ended; at += 2) {
      ended = run_until(at).has_value();
      if (ended) break;
      Record record;
      const auto report = run_until(std::nullopt, &record);
      ASSERT_TRUE(report) << at;
      EXPECT_EQ(report->resumed_at, at);
      EXPECT_EQ(report->frames, whole.report.frames);
      EXPECT_EQ(report->active_voxels, whole.report.active_voxels);
      EXPECT_EQ(report->masked, whole.report.masked);
      EXPECT_EQ(record.provenance, whole.record.provenance);
      expect_same_fields(record, whole.record);
      EXPECT_TRUE(fs::is_empty(folder_.path()));
    }
  }

  fs::path state() const { return fs::path(folder_.path()) / ".grainvdb-checkpoint" / "state"; }

  Scene scene_ = walled_scene();
  std::vector<Frame> frames_ = frames_of(scene_);
  Pipeline pipeline_ = scene_.pipeline({"phi", "velocity", "temperature", "stress", "mu"});
  TemporaryFolder folder_;
};

TEST_F(Resume, GivesTheMeanOfTwoSweeps) {
  ASSERT_EQ(make_plan(pipeline_).sweeps.size(), 2U);
  expect_the_same_wherever_it_is_interrupted();
}

TEST_F(Resume, GivesASeries) {
  pipeline_.window = 3;
  expect_the_same_wherever_it_is_interrupted();
}

// The kinetic stress is summed by blocks in the second sweep.
TEST_F(Resume, GivesStandardErrors) {
  pipeline_.fields = {"phi", "phi_error", "stress_error"};
  pipeline_.blocks = 3;
  expect_the_same_wherever_it_is_interrupted();
}

// Of eight frames two are averaged in each of two sweeps, or all where the target is out of reach.
TEST_F(Resume, GivesAnAverageThatStopsByItself) {
  pipeline_.blocks = 2;
  pipeline_.until = Until{.field = "phi", .error = 1, .relative = false, .quantile = 0.3};
  MemorySource source(frames_);
  ASSERT_EQ(run(pipeline_, source).report.stop->frames, 2U);
  pipeline_.until->error = 1e-30;
  expect_the_same_wherever_it_is_interrupted();
  pipeline_.until->error = 1;
  expect_the_same_wherever_it_is_interrupted();
}

TEST_F(Resume, GivesWindowsThatSlide) {
  pipeline_.window = 4;
  pipeline_.window_step = 2;
  expect_the_same_wherever_it_is_interrupted();
}

TEST_F(Resume, GoesOnAsOftenAsNeeded) {
  pipeline_.window = 2;
  MemorySource source(frames_);
  const Result whole = run(pipeline_, source);
  for (std::size_t at = 1; at < 16; ++at) ASSERT_FALSE(run_until(at, nullptr, 0)) << at;
  Record record;
  ASSERT_TRUE(run_until(std::nullopt, &record, 0));
  expect_same_fields(record, whole.record);
}

TEST_F(Resume, RefusesAnotherRun) {
  ASSERT_FALSE(run_until(3));
  pipeline_.resolved = "fields: some\nwindow: other\n";
  try {
    run_until(std::nullopt);
    ADD_FAILURE() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("had another pipeline"));
    EXPECT_THAT(error.what(), HasSubstr("window: some"));
    EXPECT_THAT(error.what(), HasSubstr("window: other"));
  }
}

TEST_F(Resume, RefusesADamagedState) {
  ASSERT_FALSE(run_until(3));
  std::fstream file(state(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(fs::file_size(state()) / 2));
  const int byte = file.peek();
  file.put(static_cast<char>(byte ^ 1));
  file.close();
  EXPECT_THROW(run_until(std::nullopt), InputError);
  fs::resize_file(state(), 100);
  EXPECT_THROW(run_until(std::nullopt), InputError);
  fs::resize_file(state(), 0);
  EXPECT_THROW(run_until(std::nullopt), InputError);
}

TEST_F(Resume, KeepsOtherRunsOut) {
  MemorySource source(frames_);
  std::vector<std::unique_ptr<FieldSink>> none;
  const CheckpointOptions checkpoint{folder_.path(), 0};
  bool refused = false;
  run_pipeline(
      pipeline_, make_plan(pipeline_), source, none,
      [&](const Progress&) {
        if (refused) return;
        EXPECT_THROW(run_until(std::nullopt), IoError);
        refused = true;
      },
      checkpoint);
  EXPECT_TRUE(refused);
}

TEST_F(Resume, RemovesWhatAKilledRunLeft) {
  const fs::path leftover = fs::path(folder_.path()) / "fields.hdf.4711-0.tmp";
  std::ofstream(leftover) << "unfinished";
  const fs::path of_tables = fs::path(folder_.path()) / "tables/numbers.csv.4711-1.tmp";
  fs::create_directory(of_tables.parent_path());
  std::ofstream(of_tables) << "unfinished";
  std::ofstream(fs::path(folder_.path()) / "notes.tmp") << "mine";
  ASSERT_TRUE(run_until(std::nullopt));
  EXPECT_FALSE(fs::exists(leftover));
  EXPECT_FALSE(fs::exists(of_tables));
  EXPECT_TRUE(fs::exists(fs::path(folder_.path()) / "notes.tmp"));
}

}  // namespace
}  // namespace grainvdb::testing::resume_test
