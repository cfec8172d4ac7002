// Averages that end by themselves: at the first look at which the target is met, and as a run over these frames alone.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "average/growing_blocks.hpp"
#include "grainvdb/error.hpp"
#include "stream/same_fields.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::until_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t blocks = 4;

std::vector<Frame> first(std::size_t n, const std::vector<Frame>& frames) {
  return {frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(n)};
}

double magnitude(const FieldCopy& field, const Coord& at) {
  double sum = 0;
  for (int c = 0; c < field.meta.components; ++c) sum += std::pow(static_cast<double>(field.at(at, c)), 2);
  return std::sqrt(sum);
}

/// What is compared with the target, from fields that were written: the error of the voxel at the quantile.
double error_of(const Written& w, const Until& until) {
  const FieldCopy& field = w.field(until.field);
  const FieldCopy& error = w.field(until.field + "_error");
  std::vector<double> all;
  field.for_each_active([&](const Coord& at) {
    const double value = magnitude(field, at);
    const double e = magnitude(error, at);
    if (std::isnan(value)) return;
    if (std::isnan(e)) {
      all.push_back(std::numeric_limits<double>::infinity());
    } else {
      all.push_back(until.relative && e > 0 ? e / value : e);
    }
  });
  std::sort(all.begin(), all.end());
  return all.at(static_cast<std::size_t>(std::ceil(until.quantile * static_cast<double>(all.size()))) - 1);
}

class UntilCertain : public ::testing::Test {
 protected:
  Pipeline pipeline(std::vector<std::string> fields, const Until& until) const {
    Pipeline p = scene_.pipeline(std::move(fields));
    p.input.contacts.files = {"memory"};
    p.blocks = blocks;
    p.until = until;
    return p;
  }

  /// The same over the first n frames, to their end.
  Result of_first(std::size_t n, Pipeline p, const Until& until) const {
    p.until.reset();
    p.blocks = (n + growing_block_length(blocks, n) - 1) / growing_block_length(blocks, n);
    p.fields = {until.field, until.field + "_error"};
    return run(p, first(n, scene_.frames));
  }

  /// When it should stop, by runs over 4, 5, … frames; 0: never.
  std::size_t expected_stop(const Pipeline& p) const {
    for (std::size_t n = blocks; n <= scene_.frames.size(); ++n)
      if (n % growing_block_length(blocks, n) == 0 &&
          error_of(of_first(n, p, *p.until).only(), *p.until) <= p.until->error)
        return n;
    return 0;
  }

  /// Sums by blocks are added up in another order: a unit in the last place of what is left out, weighted by √n.
  static double rounding(double error) { return 1e-5 * error; }

  Scene scene_ = moving(dilute_scene(), 22);
};

TEST_F(UntilCertain, StopsAtTheFirstLookThatMeetsTheTarget) {
  Until until{.field = "phi", .error = 0, .relative = false, .quantile = 0.3};
  const Pipeline p = pipeline({"phi", "phi_error", "velocity"}, until);
  for (const std::size_t n : {6U, 12U}) {
    Pipeline wanted = p;
    wanted.until->error = 1.0001 * error_of(of_first(n, p, until).only(), until);
    const std::size_t stop = expected_stop(wanted);
    ASSERT_GT(stop, 0U);
    ASSERT_LE(stop, n);
    const Result r = run(wanted, scene_.frames);
    ASSERT_TRUE(r.report.stop);
    EXPECT_TRUE(r.report.stop->met);
    EXPECT_EQ(r.report.stop->frames, stop);
    EXPECT_EQ(r.report.stop->frames_there, 22U);
    EXPECT_EQ(r.report.frames, stop);
    EXPECT_EQ(r.only().time.frame_count, stop);
    EXPECT_EQ(r.only().time.last_step, scene_.frames[stop - 1].step);
    EXPECT_NEAR(r.report.stop->error, error_of(r.only(), until), rounding(until.error));
    Pipeline plain = wanted;
    plain.until.reset();
    plain.fields = {"phi", "velocity"};
    Written means = r.only();
    means.fields.erase("phi_error");
    means.has_mask = false;
    expect_same_fields(means, run(plain, first(stop, scene_.frames)).only());
  }
}

TEST_F(UntilCertain, GoesOnToTheEndWhereTheTargetIsNotMet) {
  const Until until{.field = "velocity", .error = 1e-9, .relative = true, .quantile = 0.3};
  const Pipeline p = pipeline({"velocity", "velocity_error"}, until);
  const Result r = run(p, scene_.frames);
  ASSERT_TRUE(r.report.stop);
  EXPECT_FALSE(r.report.stop->met);
  EXPECT_EQ(r.report.stop->frames, 22U);
  const Result whole = of_first(22, p, until);
  EXPECT_NEAR(r.report.stop->error, error_of(r.only(), until), rounding(r.report.stop->error));
  EXPECT_GT(r.report.stop->error, 0);
  EXPECT_THAT(r.report.averaging.at(1), HasSubstr("average.until was not met after 22 of 22 frames: velocity_error/"
                                                  "|velocity| in 30 % of voxels is at most "));
  Written means = r.only(), expected = whole.only();
  for (Written* w : {&means, &expected}) w->fields.erase("velocity_error");
  means.has_mask = false;
  expect_same_fields(means, expected);
}

TEST_F(UntilCertain, SaysSoInTheResult) {
  const Pipeline p = pipeline({"phi"}, {.field = "phi", .error = 100, .relative = false, .quantile = 0.3});
  const Result r = run(p, scene_.frames);
  // Even the coarsest target waits for as many frames as blocks.
  EXPECT_EQ(r.report.frames, blocks);
  EXPECT_THAT(r.report.averaging.at(1),
              HasSubstr("stopped by average.until after 4 of 22 frames: phi_error in 30 % of voxels"));
  std::string averaging, steps, skipped;
  for (const auto& [key, text] : r.record.provenance) {
    if (key == "averaging") averaging = text;
    if (key == "steps") steps = text;
    if (key == "skipped_frames") skipped = text;
  }
  EXPECT_THAT(averaging, HasSubstr(r.report.averaging[1]));
  EXPECT_EQ(std::count(steps.begin(), steps.end(), '\n'), 4);
  EXPECT_EQ(std::count(skipped.begin(), skipped.end(), '\n'), 18);
  EXPECT_EQ(r.only().fields.size(), 1U);  // the error was not asked for
}

TEST_F(UntilCertain, ShowsHowFarItHasCome) {
  Pipeline p = pipeline({"phi", "kinetic_stress"}, {.field = "phi", .error = 100, .relative = false, .quantile = 0.3});
  MemorySource source(scene_.frames);
  std::vector<Progress> seen;
  compute_fields(
      p, make_plan(p), source, [](const OutputFields&) {}, [&](const Progress& now) { seen.push_back(now); });
  ASSERT_EQ(seen.size(), 2 * blocks);  // two sweeps
  EXPECT_EQ(seen.front().frames_total, 2 * scene_.frames.size());
  EXPECT_EQ(seen.front().error, "");
  EXPECT_THAT(seen[blocks - 1].error, HasSubstr("phi_error in 30 % of voxels at "));
  EXPECT_EQ(seen.back().frames_done, 2 * blocks);
  EXPECT_EQ(seen.back().frames_total, 2 * blocks);
}

TEST_F(UntilCertain, EndsFurtherSweepsThere) {
  const Pipeline p =
      pipeline({"phi", "kinetic_stress"}, {.field = "phi", .error = 100, .relative = false, .quantile = 0.3});
  Pipeline plain = p;
  plain.until.reset();
  Written found = run(p, scene_.frames).only();
  found.has_mask = false;
  expect_same_fields(found, run(plain, first(blocks, scene_.frames)).only());
}

/// Frames from some number on cannot be read.
class BrokenSource : public MemorySource {
 public:
  BrokenSource(std::vector<Frame> frames, std::size_t from) : MemorySource(std::move(frames)), from_(from) {}
  Frame read(std::size_t k, ColumnSet wanted) override {
    if (k >= from_) throw InputError({{"frame " + std::to_string(k), 1}, "broken", {}, {}, {}});
    return MemorySource::read(k, wanted);
  }

 private:
  std::size_t from_;
};

// However many frames are read ahead: what is wrong with those that are not wanted does not matter.
TEST_F(UntilCertain, DoesNotDependOnFramesBehind) {
  Pipeline p = pipeline({"phi", "phi_error"}, {.field = "phi", .error = 100, .relative = false, .quantile = 0.3});
  const Result whole = run(p, scene_.frames);
  for (const OnError on_error : {OnError::error, OnError::skip_frame})
    for (const std::size_t in_flight : {1U, 3U, 9U})
      for (const std::size_t threads : {1U, 3U}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        p.limits.frames_in_flight = in_flight;
        p.input.on_error = on_error;
        BrokenSource source(scene_.frames, blocks);
        const Result r = run(p, source);
        expect_same_fields(r.record, whole.record);
        EXPECT_TRUE(r.report.bad_frames.empty());
        BrokenSource broken(scene_.frames, blocks - 1);
        if (on_error == OnError::error) {
          EXPECT_THROW(run(p, broken), InputError);
        }
      }
}

// A field that is about the time mean is not known before a second sweep.
TEST_F(UntilCertain, RefusesFieldsOfASecondSweep) {
  Pipeline p = pipeline({"phi"}, {.field = "stress", .error = 1, .relative = false, .quantile = 0.3});
  EXPECT_THROW(make_plan(p), ConfigError);
  set_option(p, "kinetic_stress", "reference", std::string("time_mean_moments"));
  EXPECT_EQ(make_plan(p).sweeps.size(), 1U);
}

TEST_F(UntilCertain, WantsAsManyFramesAsBlocks) {
  const Pipeline p = pipeline({"phi"}, {.field = "phi", .error = 1, .relative = false, .quantile = 0.3});
  EXPECT_THROW(run(p, first(blocks - 1, scene_.frames)), ConfigError);
}

}  // namespace
}  // namespace grainvdb::testing::until_test
