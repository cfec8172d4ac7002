// A run that is interrupted anywhere and goes on gives what it would have given at once.
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "grainvdb/measurement.hpp"
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

/// To the last bit; undefined values are equal, too.
void expect_same_tables(const std::vector<Table>& a, const std::vector<Table>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t t = 0; t < a.size(); ++t) {
    ASSERT_EQ(a[t].columns.size(), b[t].columns.size());
    for (std::size_t c = 0; c < a[t].columns.size(); ++c) {
      const std::vector<double>&found = a[t].columns[c].values, &wanted = b[t].columns[c].values;
      ASSERT_EQ(found.size(), wanted.size());
      EXPECT_EQ(std::memcmp(found.data(), wanted.data(), found.size() * sizeof(double)), 0) << a[t].columns[c].name;
    }
  }
}

class Resume : public ::testing::Test {
 protected:
  Resume() {
    pipeline_.input.contacts.files = {"memory"};
    pipeline_.input.on_error = OnError::skip_frame;
    pipeline_.resolved = "fields: some\nwindow: some\n";
  }

  /// Runs until so many frames are done in this run, over all passes; to the end without.
  std::optional<RunReport> run_until(std::optional<std::size_t> frames, Record* record = nullptr,
                                     double interval = 1e9) {
    MemorySource source(frames_);
    const auto to = std::make_shared<Record>();
    std::vector<std::unique_ptr<FieldSink>> sinks;
    if (!pipeline_.fields.empty()) sinks.push_back(std::make_unique<MemorySink>(to));
    std::size_t visits = 0;  // of all passes
    const auto progress = [&](const Progress&) {
      if (frames && ++visits == *frames) throw Interruption();
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
    Result whole;
    if (pipeline_.fields.empty())
      whole.report = measure(pipeline_, source);
    else
      whole = run(pipeline_, source);
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
      expect_same_tables(report->tables, whole.report.tables);
      EXPECT_TRUE(fs::is_empty(folder_.path()));
    }
  }

  void measure_planes(const std::string& measurement, const std::string& axis) {
    OptionValues& options = pipeline_.measure[measurement];
    for (const OptionInfo& option : find_measurement(measurement)->options) options[option.name] = option.default_value;
    options["axis"] = axis;
    if (options.contains("source")) options["source"] = std::string("planes");
    options["area"] = 1.0;
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

// Behind the fields each pass over planes has a state of its own.
TEST_F(Resume, GivesAveragesOverPlanes) {
  measure_planes("plane_profile", "z");
  measure_planes("fluidity_fit", "x");
  for (const std::size_t window : {0U, 3U}) {
    pipeline_.window = window;
    pipeline_.fields = {"phi", "velocity", "temperature"};
    expect_the_same_wherever_it_is_interrupted();
    pipeline_.fields.clear();
    expect_the_same_wherever_it_is_interrupted();
  }
}

// The pass that was finished before is not made again.
TEST_F(Resume, KeepsPassesThatAreDone) {
  measure_planes("plane_profile", "z");
  pipeline_.fields = {"phi"};
  ASSERT_EQ(make_plan(pipeline_).sweeps.size(), 1U);
  ASSERT_FALSE(run_until(frames_.size() + 1));
  MemorySource source(frames_);
  std::vector<std::unique_ptr<FieldSink>> none;
  const RunReport report =
      run_pipeline(pipeline_, make_plan(pipeline_), source, none, {}, CheckpointOptions{folder_.path(), 1e9});
  EXPECT_GE(report.resumed_at, frames_.size() + 1);
}

TEST_F(Resume, GoesOnAsOftenAsNeeded) {
  pipeline_.window = 2;
  MemorySource source(frames_);
  const Result whole = run(pipeline_, source);
  for (int n = 1; n < 16; ++n) ASSERT_FALSE(run_until(1, nullptr, 0)) << n;
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
