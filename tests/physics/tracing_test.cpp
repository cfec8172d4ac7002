// Tracers through the fields of whole pipelines: packings that move as one, so that every path is known.
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "physics/tracing_scene.hpp"
#include "support/lattice_packing.hpp"
#include "support/memory_source.hpp"
#include "support/memory_tracers.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::tracing_test {
namespace {

using namespace testing::tracing_scene;  // NOLINT: what the tests of this scene share

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Some frames cannot be read.
class FaultySource : public MemorySource {
 public:
  FaultySource(const std::vector<Frame>& frames, std::set<std::size_t> bad)
      : MemorySource(frames), bad_(std::move(bad)) {}
  Frame read(std::size_t k, ColumnSet wanted) override {
    if (bad_.contains(k)) throw InputError({{"frame", 7}, "a bad row", {}, {}, {}});
    return MemorySource::read(k, wanted);
  }

 private:
  std::set<std::size_t> bad_;
};

TEST(TraceThroughTheMean, MovesWithAUniformFlowAcrossPeriodicBoundaries) {
  Pipeline p = through_mean({{0, 0, 0}, {5.25, 1.5, 7.4}}, 20, 0.5);
  p.trace->every = 8;
  const Histories h = trace(p, frames_of(uniform, {0, 1}));
  EXPECT_THAT(times_of(h), ElementsAre(0, 4, 8, 12, 16, 20));
  EXPECT_THAT(steps_of(h), ElementsAre(0, 8, 16, 24, 32, 40));
  for (const std::size_t i : {0U, 1U}) expect_near(h.displacement(i), {14, -8, 4}, 14 * exact);
  const TracerSample& last = h.samples.back();
  EXPECT_NEAR(last.position[0][0], 14 - 2 * sites + sites, 14 * exact);  // x in [-½, 7½): 14 is 6 and one period
  EXPECT_EQ(last.image[0][0], 1);
  EXPECT_EQ(last.image[1][0], -1);
  EXPECT_EQ(last.stop[0], TracerStop::moving);
  EXPECT_LT(last.strain[0], 20 * 1e-4);  // differences of equal velocities: rounding over h
  EXPECT_NEAR(last.courant[0], std::hypot(u0[0], u0[1], u0[2]) * 0.5 / 0.5, exact);
  EXPECT_EQ(h.report.trace->tracers, 2U);
  EXPECT_EQ(h.report.trace->samples, 6U);
  EXPECT_EQ(h.report.trace->steps, 80U);
}

TEST(TraceThroughTheMean, TakesTheTimeOfTheFramesWhereNoDurationIsGiven) {
  Pipeline p = through_mean({{1, 1, 1}}, 0, 0.5);
  p.trace->duration.reset();
  EXPECT_THAT(times_of(trace(p, frames_of(uniform, {2, 3, 3.25}))), ElementsAre(0, 0.5, 1, 1.25));
  p.trace->dt.reset();
  p.trace->steps = 5;
  EXPECT_THAT(times_of(trace(p, frames_of(uniform, {2, 3, 3.25}))), ElementsAre(0, 0.25, 0.5, 0.75, 1, 1.25));
}

TEST(TraceThroughTheMean, GoesBackToWhereItCameFrom) {
  const auto swirl = [](const Vec3& x, double) {
    const double k = 2 * M_PI / sites;
    return Vec3{std::sin(k * x[1]), std::cos(k * x[0]), 0.3 * std::sin(k * x[0])};
  };
  const auto frames = frames_of(swirl, {0, 1});
  Pipeline p = through_mean({{1, 2, 3}}, 6, 0.05);
  const Histories there = trace(p, frames);
  const Vec3 d = there.displacement(0);
  EXPECT_GT(std::hypot(d[0], d[1], d[2]), 1);
  p.trace->seeds.points = {{1 + d[0], 2 + d[1], 3 + d[2]}};
  p.trace->direction = TraceSpec::Direction::backward;
  const Histories back = trace(p, frames);
  // Steps of 0.05 are far shorter than a voxel: what is left is rounding of double and of the grid's floats.
  expect_near(back.displacement(0), {-d[0], -d[1], -d[2]}, 1e-5);
  EXPECT_NEAR(back.samples.back().strain[0], there.samples.back().strain[0], 1e-5);
  EXPECT_THAT(back.layout.time_meaning, HasSubstr("back from the start"));
}

TEST(TraceThroughTheMean, RecordsTheFieldsWhereTheTracersAre) {
  const auto shear = [](const Vec3& x, double) { return Vec3{std::sin(2 * M_PI * x[2] / sites), 0, 0}; };
  Pipeline p = through_mean({{0.3, 2, 1.1}, {4, 4, 5}}, 4, 0.1);
  p.trace->record = {"velocity", "shear_rate", "phi"};
  p.fields = {"phi", "temperature"};
  const Histories h = trace(p, frames_of(shear, {0, 1}));
  ASSERT_EQ(h.samples.size(), 41U);
  EXPECT_EQ(h.layout.fields.size(), 3U);
  EXPECT_EQ(h.layout.fields[1].name, "shear_rate");
  EXPECT_EQ(h.layout.fields[1].unit, "1/s");
  // At constant z tracers keep their velocity and shear rate, but for the ripple of the packing along x, ±0.2 % of φ.
  for (const std::size_t i : {0U, 1U}) {
    const double speed = static_cast<double>(h.samples[0].fields[0][3 * i]);
    EXPECT_GT(std::abs(speed), 0.2);
    EXPECT_NEAR(h.displacement(i)[0], 4 * speed, 0.01 * 4);
    EXPECT_NEAR(h.samples.back().strain[i], 4 * static_cast<double>(h.samples[0].fields[1][i]), 0.01 * 4);
    EXPECT_NEAR(static_cast<double>(h.samples.back().fields[2][i]), M_PI / 6, 0.01);
  }
  ASSERT_EQ(h.fields.times.size(), 1U);  // along with the fields that are written, and no others
  EXPECT_EQ(h.fields.times[0].fields.size(), 2U);
}

// u is linear in time between frames, and the exact path quadratic: Runge-Kutta steps know both.
TEST(TraceThroughFrames, FollowsAVelocityThatChangesInTime) {
  const Pipeline p = through_frames({{1, 2, 3}});
  const Histories h = trace(p, frames_of(accelerating, {1, 2, 2.5, 4}));
  EXPECT_THAT(times_of(h), ElementsAre(1, 2, 2.5, 4));
  EXPECT_THAT(steps_of(h), ElementsAre(1000, 2000, 2500, 4000));
  const double t2 = (16 - 1) / 2.0;  // ∫ t dt
  expect_near(h.displacement(0), {3 * u0[0] + 0.3 * t2, 3 * u0[1], 3 * u0[2] - 0.1 * t2}, 6 * exact);
  EXPECT_EQ(h.layout.time_meaning, "time of the simulation");
  EXPECT_EQ(h.report.trace->steps, 3U);
}

TEST(TraceThroughFrames, GoesBackToWhereItCameFrom) {
  Pipeline p = through_frames({{1, 2, 3}});
  p.trace->direction = TraceSpec::Direction::backward;
  const Histories h = trace(p, frames_of(accelerating, {1, 2, 2.5, 4}));
  EXPECT_THAT(times_of(h), ElementsAre(0, 1.5, 2, 3));
  EXPECT_THAT(steps_of(h), ElementsAre(0, 1, 2, 3));
  const double t2 = (16 - 1) / 2.0;
  expect_near(h.displacement(0), {-3 * u0[0] - 0.3 * t2, -3 * u0[1], -3 * u0[2] + 0.1 * t2}, 6 * exact);
}

TEST(TraceThroughFrames, SamplesEveryOutputTimeOrEveryFewAndTheLast) {
  Pipeline p = through_frames({{1, 2, 3}});
  p.trace->every = 3;
  p.trace->dt = 0.1;
  const std::vector<double> times{0, 1, 2, 3, 4, 5, 6, 7};
  const Histories h = trace(p, frames_of(uniform, times));
  EXPECT_THAT(times_of(h), ElementsAre(0, 3, 6, 7));
  EXPECT_EQ(h.report.trace->steps, 70U);
  p.window = 2;
  EXPECT_THAT(times_of(trace(p, frames_of(uniform, times))), ElementsAre(0.5, 6.5));
  p.trace->direction = TraceSpec::Direction::backward;
  EXPECT_THAT(times_of(trace(p, frames_of(uniform, times))), ElementsAre(0.5, 6.5));
}

TEST(TraceThroughFrames, SaysWhenHistoriesMeanNothing) {
  const auto frames = frames_of(uniform, {0, 1, 2});  // |u|Δt/h = 1.66
  Pipeline p = through_frames({{1, 2, 3}, {4, 4, 4}});
  const Histories h = trace(p, frames);
  EXPECT_FALSE(h.report.trace->is_meaningful());
  EXPECT_EQ(h.report.trace->above_courant_limit, 4U);
  EXPECT_EQ(h.report.trace->above_gradient_limit, 0U);
  EXPECT_EQ(h.report.trace->moves, 4U);
  EXPECT_NEAR(h.report.trace->largest_courant, 2 * std::hypot(u0[0], u0[1], u0[2]), exact);
  EXPECT_THAT(h.provenance_text("trace"),
              AllOf(HasSubstr("2 tracers, 3 samples: 2 moving to the end"), HasSubstr("not meaningful"),
                    HasSubstr("of 4 moves from one output time to the next, 0 had K > 0.3 and 4 had Co > 1"),
                    HasSubstr("trace.through: mean")));
  p.trace->limits.courant = 1.7;
  EXPECT_TRUE(trace(p, frames).report.trace->is_meaningful());
  p.trace->limits = {};
  // As long steps through the mean are coarse, but mean something.
  const Histories mean = trace(through_mean({{1, 2, 3}}, 2, 1), frames);
  EXPECT_TRUE(mean.report.trace->is_meaningful());
  EXPECT_THAT(mean.provenance_text("trace"), Not(HasSubstr("not meaningful")));
  // Twice as dense in time, they do through frames as well.
  EXPECT_TRUE(trace(p, frames_of(uniform, {0, 0.5, 1})).report.trace->is_meaningful());
}

TEST(Trace, EndsWhereTheMaterialEndsAndKeepsTheLastGoodSample) {
  Pipeline p = through_mean({{3, 3, 3}, {3, 3, 30}}, 40, 0.1);
  p.trace->every = 20;
  const Histories h = trace(p, frames_of([](const Vec3&, double) { return Vec3{0, 0, 0.5}; }, {0, 1}, false));
  EXPECT_EQ(h.samples.back().stop[0], TracerStop::left_domain);  // of the open box, at 7½: the material reaches 9
  EXPECT_NEAR(h.samples.back().position[2][0], 7, 7 * exact);    // samples are a length of 1 apart
  EXPECT_NEAR(h.samples.back().stop_time[0], 9, 0.1);
  EXPECT_EQ(h.samples.back().stop[1], TracerStop::left_domain);
  EXPECT_EQ(h.samples.back().displacement[2][1], 0);
  EXPECT_EQ(h.report.trace->ended.at(TracerStop::left_domain), 2U);
  EXPECT_EQ(h.samples.size(), 21U);
}

TEST(Trace, StopsAtAHoleAndKeepsTheLastGoodSample) {
  auto frames = frames_of([](const Vec3&, double) { return Vec3{0.5, 0, 0}; }, {0, 1});
  for (Frame& frame : frames) erase(frame.particles, [](const Vec3& x) { return x[0] > 1.5 && x[0] < 6.5; });
  Pipeline p = through_mean({{0, 3, 3}, {6, 3, 3}}, 8, 0.1);
  p.trace->every = 10;
  p.trace->record = {"phi", "velocity"};
  const Histories h = trace(p, frames);
  // The last grains are at x = 1, and kernels reach 2 from there: the last active voxel is at 2.75.
  const TracerSample& last = h.samples.back();
  ASSERT_EQ(h.samples.size(), 9U);
  EXPECT_EQ(last.stop[0], TracerStop::left_material);
  EXPECT_NEAR(last.stop_time[0], 2.75 / 0.5, 0.1 / 128 + 6 * exact);
  EXPECT_NEAR(last.position[0][0], 2.5, 3 * exact);
  EXPECT_GT(last.fields[0][0], 0);
  EXPECT_NEAR(last.fields[1][0], 0.5, exact);
  EXPECT_EQ(last.fields[0][0], h.samples[5].fields[0][0]);
  EXPECT_EQ(h.samples[5].stop[0], TracerStop::moving);
  EXPECT_EQ(last.stop[1], TracerStop::moving);  // on the far side, across the boundary of the box
  EXPECT_EQ(h.report.trace->ended.at(TracerStop::left_material), 1U);
}

TEST(Trace, ReturnsToItsStartInAPeriodicFlow) {
  for (const auto scheme : {TraceSpec::Scheme::rk4, TraceSpec::Scheme::adaptive}) {
    // Twice through the box along x, once along z.
    Pipeline p = through_mean({{0.2, 3.3, 1.1}}, 16, 0.25);
    p.trace->scheme = scheme;
    if (scheme == TraceSpec::Scheme::adaptive) p.trace->tolerance = 1e-6;
    const Histories h = trace(p, frames_of([](const Vec3&, double) { return Vec3{1, 0, -0.5}; }, {0, 1}));
    const TracerSample& last = h.samples.back();
    for (const std::size_t a : {0U, 1U, 2U})
      EXPECT_NEAR(last.position[a][0], h.samples[0].position[a][0], 16 * exact) << "xyz"[a];
    EXPECT_EQ(last.image[0][0], 2);
    EXPECT_EQ(last.image[2][0], -1);
  }
}

TEST(TraceThroughFrames, GoesOnOverFramesThatWereLeftOut) {
  Pipeline p = through_frames({{1, 2, 3}});
  p.input.on_error = OnError::skip_frame;
  const auto frames = frames_of(uniform, {0, 1, 2, 3});
  const auto histories = [&](const std::set<std::size_t>& bad) {
    FaultySource source(frames, bad);
    return trace(p, source);
  };
  const Histories h = histories({1});
  EXPECT_THAT(times_of(h), ElementsAre(0, 2, 3));
  expect_near(h.displacement(0), {3 * u0[0], 3 * u0[1], 3 * u0[2]}, 3 * exact);
  EXPECT_EQ(h.report.bad_frames.size(), 1U);
  EXPECT_THAT(times_of(histories({0})), ElementsAre(1, 2, 3));
  EXPECT_THAT(times_of(histories({3})), ElementsAre(0, 1, 2));
  EXPECT_THROW(histories({0, 1, 2}), InputError);
  p.window = 2;
  p.window_step = 1;
  EXPECT_THAT(times_of(histories({0, 2})), ElementsAre(1, 3));  // the second window has no time of its own
}

TEST(Trace, ComputesNothingThatTheTracersDoNotNeed) {
  Pipeline p = through_mean({{1, 1, 1}}, 1, 0.5);
  p.trace->strain = false;
  p.trace->neighbourhood = TraceSpec::Neighbourhood::never;  // whose cost takes a look at the first frame
  MemorySource source(frames_of(uniform, {0, 1}));
  const Histories h = trace(p, source);
  EXPECT_EQ(h.report.channels, 4U);  // Σ V W and Σ V v W
  EXPECT_TRUE(h.samples.back().strain.empty());
  EXPECT_THAT(source.counters().columns_parsed, ElementsAre("id", "position", "radius", "velocity"));
  EXPECT_EQ(source.counters().frames_read, 2U);
}

TEST(Trace, GivesTheSameAlongWithFieldsAndAlone) {
  for (const auto direction : {TraceSpec::Direction::forward, TraceSpec::Direction::backward}) {
    Pipeline p = through_frames({{1, 2, 3}, {5, 5, 5.5}});
    p.trace->direction = direction;
    p.trace->record = {"phi"};
    const auto frames = frames_of(accelerating, {0, 0.5, 1});
    const Histories alone = trace(p, frames);
    p.fields = {"phi", "velocity"};
    const Histories along = trace(p, frames);
    EXPECT_TRUE(same_histories(alone, along));
    EXPECT_EQ(along.fields.times.size(), 3U);
    EXPECT_EQ(along.fields.times[0].time.time, 0);
    EXPECT_EQ(alone.fields.times.size(), 0U);
  }
}

std::string refusal(const Pipeline& p, const std::vector<Frame>& frames) {
  try {
    trace(p, frames);
  } catch (const Error& e) {
    return e.what();
  }
  return "not refused";
}

TEST(Trace, RefusesWhatTheInputCannotGive) {
  auto frames = frames_of(uniform, {0, 1});
  EXPECT_THAT(refusal(through_mean({{40, 0, 0}}, 1, 1), frames_of(uniform, {0, 1}, false)),
              HasSubstr("no seed of a tracer lies in the material; found 1 seeds"));
  Pipeline p = through_mean({}, 1, 1);
  p.trace->seeds.particles = {{7000}, 1};
  EXPECT_THAT(refusal(p, frames), HasSubstr("7000"));
  EXPECT_THAT(refusal(through_frames({{1, 1, 1}}), {frames[0]}), HasSubstr("and there is one"));
  frames[0].time.reset();
  frames[1].time.reset();
  EXPECT_THAT(refusal(through_frames({{1, 1, 1}}), frames), HasSubstr("the dump has no time"));
  p = through_mean({{1, 1, 1}}, 1, 1);
  EXPECT_THAT(refusal(p, frames), HasSubstr("not refused"));  // a duration is all that is needed
  p.trace->duration.reset();
  EXPECT_THAT(refusal(p, frames), HasSubstr("trace.duration or input.dt"));
}

}  // namespace
}  // namespace grainvdb::testing::tracing_test
