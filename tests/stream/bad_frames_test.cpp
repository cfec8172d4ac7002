// Frames that cannot be used are left out of every sum, and never silently.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/measurement.hpp"
#include "stream/same_fields.hpp"
#include "support/memory_source.hpp"
#include "support/memory_tracers.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::bad_frames_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Some frames cannot be read when a certain column is wanted.
class FaultySource : public MemorySource {
 public:
  FaultySource(std::vector<Frame> frames, std::multimap<std::int64_t, ColumnSet> faults)
      : MemorySource(std::move(frames)), faults_(std::move(faults)) {}
  Frame read(std::size_t k, ColumnSet wanted) override {
    const FrameInfo& frame = frames()[k];
    const auto [first, last] = faults_.equal_range(frame.step);
    for (auto fault = first; fault != last; ++fault)
      if ((wanted | fault->second) == wanted) throw InputError({{frame.file, 7}, reason(fault->second), {}, {}, {}});
    return MemorySource::read(k, wanted);
  }

 private:
  static std::string reason(ColumnSet columns) {
    std::string text = "a bad row";
    for (const std::string& column : column_names(columns))
      if (column != "id" && column != "position") text += ", " + column;
    return text;
  }

  std::multimap<std::int64_t, ColumnSet> faults_;
};

void measure_by_default(Pipeline& p, const std::string& measurement) {
  for (const OptionInfo& option : find_measurement(measurement)->options)
    p.measure[measurement][option.name] = option.default_value;
}

/// Seven frames of two kinds in turn, at the steps 0, 10, … 60.
std::vector<Frame> frames_of(const Scene& scene) {
  std::vector<Frame> frames;
  for (int k = 0; k < 7; ++k) {
    Frame frame = scene.frames[static_cast<std::size_t>(k) % scene.frames.size()];
    frame.file = "frame" + std::to_string(k);
    frame.step = 10 * k;
    frame.time = 0.1 * k;
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<Frame> without(std::vector<Frame> frames, const std::vector<std::int64_t>& steps) {
  std::erase_if(frames, [&](const Frame& f) { return std::find(steps.begin(), steps.end(), f.step) != steps.end(); });
  return frames;
}

class SkippedFrames : public ::testing::Test {
 protected:
  Pipeline skipping(std::vector<std::string> fields) const {
    Pipeline p = scene_.pipeline(std::move(fields));
    p.input.contacts.files = {"memory"};
    p.input.on_error = OnError::skip_frame;
    return p;
  }
  Scene scene_ = walled_scene();
  std::vector<Frame> frames_ = frames_of(scene_);
};

// The mass is wanted by the second sweep alone: the frame must be out of the first one, too.
TEST_F(SkippedFrames, AreInNoSumOfAnySweep) {
  Pipeline p = skipping({"phi", "velocity", "stress"});
  ASSERT_EQ(make_plan(p).sweeps.size(), 2U);
  FaultySource faulty(frames_, {{20, Column::mass}, {60, Column::contacts}});
  const Result result = run(p, faulty);
  MemorySource good(without(frames_, {20, 60}));
  const Result expected = run(p, good);
  expect_same_fields(result.record, expected.record);
  EXPECT_EQ(result.report.frames, 5U);
  ASSERT_THAT(result.report.bad_frames, SizeIs(2));
  EXPECT_EQ(result.report.bad_frames[0].step, 20);
  EXPECT_EQ(result.report.bad_frames[1].step, 60);
  EXPECT_THAT(result.report.bad_frames[0].reason, HasSubstr("frame2:7: a bad row"));
}

// Averages over planes, which read less, must be of the frames that the fields are of.
TEST_F(SkippedFrames, AreInNoAverageOverPlanes) {
  Pipeline p = skipping({"contact_stress"});
  measure_by_default(p, "plane_profile");
  FaultySource faulty(frames_, {{20, Column::contacts}, {40, Column::mass}});
  const Result result = run(p, faulty);
  MemorySource good(without(frames_, {20, 40}));
  const Result expected = run(p, good);
  ASSERT_THAT(result.report.tables, SizeIs(1));
  const std::vector<TableColumn>&found = result.report.tables[0].columns, &wanted = expected.report.tables[0].columns;
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (found[c].name.ends_with("_error")) continue;  // of seven output times, two of them empty
    EXPECT_EQ(found[c].values, wanted[c].values) << found[c].name;
  }
  ASSERT_THAT(result.report.bad_frames, SizeIs(2));  // of which the second is bad for density alone
  EXPECT_THAT(result.report.bad_frames[0].reason, HasSubstr("a bad row"));
}

// Passes that read contacts and masses find different faults in one frame, and the same ones in others.
TEST_F(SkippedFrames, StandWithAllThatIsWrongWithThem) {
  Pipeline p = skipping({});
  measure_by_default(p, "plane_profile");
  measure_by_default(p, "coordination");
  p.measure["coordination"]["contacts"] = std::string("dump");
  FaultySource faulty(frames_, {{20, Column::contacts}, {20, Column::mass}, {30, {}}});
  const RunReport report = measure(p, faulty);
  ASSERT_THAT(report.bad_frames, SizeIs(2));
  EXPECT_EQ(report.bad_frames[0].step, 20);
  EXPECT_EQ(report.bad_frames[0].reason, "frame2:7: a bad row, contacts; frame2:7: a bad row, mass");
  EXPECT_EQ(report.bad_frames[1].reason, "frame3:7: a bad row");
  // Those that fields leave out are known to be bad, whatever measurements read.
  p.fields = {"contact_stress"};
  const Result after_fields = run(p, faulty);
  ASSERT_THAT(after_fields.report.bad_frames, SizeIs(2));
  EXPECT_EQ(after_fields.report.bad_frames[0].reason, "frame2:7: a bad row, contacts");
}

// A block that loses all its frames does not count; seven frames in five blocks are 1, 1, 2, 1, 2.
TEST_F(SkippedFrames, AreInNoBlockOfAStandardError) {
  Pipeline p = skipping({"phi", "phi_error", "velocity_error", "mask"});
  p.blocks = 5;
  FaultySource faulty(frames_, {{10, {}}, {30, {}}});
  const Result result = run(p, faulty);
  // What is left is in four blocks of 1, 1, 1 and 2.
  MemorySource good(without(frames_, {10, 30}));
  p.blocks = 4;
  const Result expected = run(p, good);
  expect_same_fields(result.record, expected.record);
  const FieldCopy& error = result.only().field("phi_error");
  EXPECT_GT(std::count_if(error.values.begin(), error.values.end(), [](float e) { return e > 0; }), 1000);
}

// With a single block left there is no error, and the mask says so.
TEST_F(SkippedFrames, LeaveNoStandardErrorWhereOneBlockIsLeft) {
  Pipeline p = skipping({"phi_error"});
  p.blocks = 2;
  FaultySource faulty(frames_, {{0, {}}, {10, {}}, {20, {}}});
  const Result result = run(p, faulty);
  const Written& written = result.only();
  EXPECT_GT(written.field("phi_error").topology->active_voxel_count(), 0U);
  written.field("phi_error").for_each_active([&](const Coord& at) {
    EXPECT_TRUE(std::isnan(written.field("phi_error").at(at)));
    EXPECT_TRUE(written.mask_at(at) & static_cast<std::uint32_t>(Reason::few_blocks));
  });
}

TEST_F(SkippedFrames, StandInTheProvenance) {
  FaultySource faulty(frames_, {{0, {}}, {30, {}}});
  const Result result = run(skipping({"phi"}), faulty);
  std::map<std::string, std::string> provenance(result.record.provenance.begin(), result.record.provenance.end());
  EXPECT_EQ(provenance.at("steps"), "10\n20\n40\n50\n60\n");
  EXPECT_EQ(provenance.at("bad_frames"), "step 0: frame0:7: a bad row\nstep 30: frame3:7: a bad row\n");
}

TEST_F(SkippedFrames, EndTheRunUnlessAskedFor) {
  Pipeline p = skipping({"phi"});
  p.input.on_error = OnError::error;
  FaultySource faulty(frames_, {{30, {}}});
  EXPECT_THROW(run(p, faulty), InputError);
}

// A pass behind that for fields fails, whose output may still be on its way to the sinks.
TEST_F(SkippedFrames, EndTheRunInALaterPass) {
  Pipeline p = skipping({"phi"});
  p.input.on_error = OnError::error;
  measure_by_default(p, "plane_profile");
  FaultySource faulty(frames_, {{60, Column::mass}});
  for (int n = 0; n < 20; ++n) EXPECT_THROW(run(p, faulty), InputError);
}

TEST_F(SkippedFrames, LeaveTheirWindowTheRest) {
  Pipeline p = skipping({"phi", "kinetic_stress"});
  p.window = 3;
  FaultySource faulty(frames_, {{30, {}}, {50, {}}});
  const Result result = run(p, faulty);
  ASSERT_THAT(result.record.times, SizeIs(3));
  MemorySource alone(std::vector<Frame>{frames_[4]});
  expect_same_fields(result.record.times[1], run(p, alone).only());
  EXPECT_EQ(result.record.times[1].time.frame_count, 1U);
  EXPECT_EQ(result.record.times[0].time.frame_count, 3U);
}

// Parts that windows share begin with a bad frame, or have no other.
TEST_F(SkippedFrames, LeaveWindowsThatSlideTheRest) {
  Pipeline p = skipping({"phi", "kinetic_stress"});
  p.window = 4;
  p.window_step = 2;
  FaultySource faulty(frames_, {{20, {}}, {40, {}}, {50, {}}});
  const Result result = run(p, faulty);
  ASSERT_THAT(result.record.times, SizeIs(3));
  const std::vector<std::vector<std::int64_t>> bad{{20, 40, 50, 60}, {0, 10, 20, 40, 50, 60}, {0, 10, 20, 30, 40, 50}};
  for (std::size_t w = 0; w < 3; ++w) {
    Pipeline alone = p;
    alone.window = alone.window_step = 0;
    MemorySource good(without(frames_, bad[w]));
    expect_same_fields(result.record.times[w], run(alone, good).only());
  }
}

TEST_F(SkippedFrames, MayLeaveAnOutputTimeWithoutVoxels) {
  Pipeline p = skipping({"phi"});
  p.window = 1;
  FaultySource faulty(frames_, {{30, {}}});
  const Result result = run(p, faulty);
  ASSERT_THAT(result.record.times, SizeIs(7));
  const Written& empty = result.record.times[3];
  EXPECT_EQ(empty.time.frame_count, 0U);
  EXPECT_EQ(empty.time.first_step, 30);
  EXPECT_DOUBLE_EQ(empty.time.time, 0.3);
  EXPECT_EQ(empty.field("phi").topology->leaf_count(), 0U);
  EXPECT_TRUE(empty.has_mask);  // so that it can be told from an empty box
}

TEST_F(SkippedFrames, AreNotAllThereIs) {
  std::multimap<std::int64_t, ColumnSet> all;
  for (const Frame& f : frames_) all.emplace(f.step, ColumnSet());
  for (const std::size_t window : {0, 1, 3}) {
    Pipeline p = skipping({"phi"});
    p.window = window;
    FaultySource faulty(frames_, all);
    try {
      run(p, faulty);
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("every frame is bad"), HasSubstr("frame6:7: a bad row")));
    }
  }
}

// The contacts of the first frame are bad, its particles are not: tracers start on those of the second all the same.
TEST_F(SkippedFrames, AreNotThoseOnWhichTracersStart) {
  for (double& z : frames_[1].particles.position[2]) z += 0.01;
  const Particles& second = frames_[1].particles;
  for (const auto through : {TraceSpec::Through::mean, TraceSpec::Through::frames}) {
    Pipeline p = skipping({"stress"});
    p.trace.emplace();
    p.trace->through = through;
    p.trace->strain = false;
    p.trace->seeds.particles.emplace(SeedSpec::OnParticles{{}, 20});
    p.window = through == TraceSpec::Through::frames ? 1 : 0;
    if (through == TraceSpec::Through::mean) p.trace->duration = 0.1, p.trace->dt = 0.05;
    FaultySource faulty(frames_, {{0, Column::contacts}});
    const Histories h = trace(p, faulty);
    ASSERT_THAT(h.layout.id, SizeIs(::testing::Ge(2U)));
    for (std::size_t i = 0; i < h.layout.id.size(); ++i) {
      const auto row = std::find(second.id.begin(), second.id.end(), h.layout.id[i]) - second.id.begin();
      EXPECT_EQ(h.samples[0].position[2][i], second.position[2].at(static_cast<std::size_t>(row)));
    }
    EXPECT_DOUBLE_EQ(h.samples[0].time, through == TraceSpec::Through::frames ? 0.1 : 0.0);
  }
}

TEST_F(SkippedFrames, LeaveNoSeedsWhereAllAreBad) {
  Pipeline p = skipping({"phi"});
  p.trace.emplace();
  p.trace->duration = 0.1;
  p.trace->dt = 0.05;
  p.trace->seeds.particles.emplace(SeedSpec::OnParticles{{}, 20});
  std::multimap<std::int64_t, ColumnSet> all;
  for (const Frame& f : frames_) all.emplace(f.step, ColumnSet());
  FaultySource faulty(frames_, all);
  EXPECT_THROW(trace(p, faulty), InputError);
}

// Files are in flight in any order, what is found in them is not.
TEST_F(SkippedFrames, AreTheSameForAnyNumberInFlight) {
  std::vector<Result> results;
  for (const std::size_t in_flight : {1U, 8U}) {
    Pipeline p = skipping({"phi", "stress"});
    p.window = 2;
    p.limits.frames_in_flight = in_flight;
    FaultySource faulty(frames_, {{10, Column::mass}, {40, Column::contacts}});
    results.push_back(run(p, faulty));
  }
  expect_same_fields(results[0].record, results[1].record);
  EXPECT_THAT(results[1].report.bad_frames, SizeIs(2));
}

}  // namespace
}  // namespace grainvdb::testing::bad_frames_test
