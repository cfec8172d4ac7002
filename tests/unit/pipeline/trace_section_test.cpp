#include <cmath>

#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb::trace_section_test {
namespace {

using test::load;
using test::minimal_text;
using test::refusal;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

/// The minimal file with a trace section; its first line is line 10.
std::string with_trace(const std::string& inside) {
  return minimal_text() + "trace:\n" + inside;
}

const std::string points = "  seeds: {points: [[1, 2, 3]]}\n";

TEST(TraceSection, IsAbsentUnlessGiven) {
  const Pipeline p = load(minimal_text());
  EXPECT_FALSE(p.trace);
  EXPECT_THAT(p.resolved, Not(HasSubstr("trace")));
  EXPECT_THAT(computed_fields(p), ElementsAre("phi", "velocity"));
}

TEST(TraceSection, HasDefaults) {
  const Pipeline p = load(with_trace(points + "  steps: 10\n"));
  ASSERT_TRUE(p.trace);
  const TraceSpec& t = *p.trace;
  EXPECT_THAT(t.seeds.points, ElementsAre(Vec3{1, 2, 3}));
  EXPECT_FALSE(t.seeds.grid);
  EXPECT_FALSE(t.seeds.particles);
  EXPECT_EQ(t.through, TraceSpec::Through::mean);
  EXPECT_EQ(t.scheme, TraceSpec::Scheme::rk4);
  EXPECT_EQ(t.interpolation, Interpolation::trilinear);
  EXPECT_EQ(t.direction, TraceSpec::Direction::forward);
  EXPECT_EQ(t.neighbourhood, TraceSpec::Neighbourhood::automatic);
  EXPECT_EQ(t.on_undefined, OnUndefined::stop);
  EXPECT_EQ(t.steps, 10);
  EXPECT_TRUE(t.strain);
  EXPECT_EQ(t.every, 1);
  EXPECT_THAT(t.record, IsEmpty());
  EXPECT_THAT(t.formats, ElementsAre("h5md"));
}

TEST(TraceSection, ReadsEveryKeyAndResolvesToTheSame) {
  const std::string text = with_trace(R"(
  seeds: {grid: {lo: [0, -.inf, 1], hi: [2, .inf, 1], spacing: 0.5}}
  through: mean
  scheme: adaptive
  interpolation: cubic
  direction: backward
  dt: 0.25
  duration: 7
  tolerance: 1.0e-3
  record: [phi, temperature]
  strain: false
  on_undefined: carry_on
  every: 3
  formats: [h5md, lammps]
  neighbourhood: never
)");
  const Pipeline p = load(text);
  const auto check = [](const Pipeline& q) {
    const TraceSpec& t = *q.trace;
    EXPECT_EQ(t.seeds.grid->lo, (Vec3{0, -INFINITY, 1}));
    EXPECT_EQ(t.seeds.grid->hi, (Vec3{2, INFINITY, 1}));
    EXPECT_EQ(t.seeds.grid->spacing, (Vec3{0.5, 0.5, 0.5}));
    EXPECT_EQ(t.scheme, TraceSpec::Scheme::adaptive);
    EXPECT_EQ(t.interpolation, Interpolation::tricubic);
    EXPECT_EQ(t.direction, TraceSpec::Direction::backward);
    EXPECT_EQ(t.dt, 0.25);
    EXPECT_EQ(t.duration, 7.0);
    EXPECT_EQ(t.tolerance, 1e-3);
    EXPECT_THAT(t.record, ElementsAre("phi", "temperature"));
    EXPECT_FALSE(t.strain);
    EXPECT_EQ(t.on_undefined, OnUndefined::carry_on);
    EXPECT_EQ(t.every, 3);
    EXPECT_THAT(t.formats, ElementsAre("h5md", "lammps"));
    EXPECT_EQ(t.neighbourhood, TraceSpec::Neighbourhood::never);
    EXPECT_THAT(computed_fields(q), ElementsAre("phi", "velocity", "temperature"));
  };
  check(p);
  check(load(p.resolved));
}

TEST(TraceSection, ReadsTheOtherSeeds) {
  const auto seeds = [](const std::string& text) {
    return load(with_trace("  through: frames\n  seeds: " + text + '\n')).trace->seeds;
  };
  EXPECT_THAT(seeds("{points: [[1, 2, 3], [-1, 0.5, 2e3]]}").points, ElementsAre(Vec3{1, 2, 3}, Vec3{-1, 0.5, 2000}));
  EXPECT_THAT(seeds("{particles: {ids: [7, 3]}}").particles->ids, ElementsAre(7, 3));
  EXPECT_EQ(seeds("{particles: {every: 10}}").particles->every, 10U);
  EXPECT_EQ(seeds("{grid: {spacing: [1, 2, 3]}}").grid->spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(seeds("{grid: {spacing: 2}}").grid->lo, (Vec3{-INFINITY, -INFINITY, -INFINITY}));
}

TEST(TraceSection, StandsWithoutAnOutput) {
  std::string text = with_trace(points + "  steps: 10\n  strain: false\n");
  const std::size_t output = text.find("output:");
  text.erase(output, text.find("trace:") - output);
  const Pipeline p = load(text);
  EXPECT_THAT(p.fields, IsEmpty());
  EXPECT_THAT(p.formats, IsEmpty());
  EXPECT_THAT(computed_fields(p), ElementsAre("velocity"));
  EXPECT_THAT(refusal(text.substr(0, output)), HasSubstr("FILE: the section 'output' is missing"));
}

TEST(TraceSection, ErrorsNameTheLineAndWhatWasMeant) {
  const auto refused = [](const std::string& inside) { return refusal(with_trace(inside)); };
  EXPECT_THAT(refused(points + "  stepz: 3\n"),
              AllOf(StartsWith("FILE:12: unknown key 'stepz'"), HasSubstr("Did you mean 'steps'?")));
  EXPECT_THAT(refused(points + "  steps: 3\n  record: [velocty]\n"),
              AllOf(StartsWith("FILE:13:"), HasSubstr("Did you mean 'velocity'?")));
  EXPECT_THAT(refused(points + "  steps: 3\n  record: [mask]\n"), HasSubstr("FILE:13: unknown name in trace.record"));
  EXPECT_THAT(refused(points + "  steps: 3\n  through: frame\n"), HasSubstr("Did you mean 'frames'?"));
  EXPECT_THAT(refused("  steps: 3\n"), HasSubstr("the section 'trace.seeds' is missing"));
  EXPECT_THAT(refused("  seeds: {points: [[1, 2]]}\n"),
              AllOf(StartsWith("FILE:11: trace.seeds.points has an item that is no place"), HasSubstr("[x, y, z]")));
  EXPECT_THAT(refused("  seeds: {grid: {spacing: 0}}\n"), HasSubstr("trace.seeds.grid.spacing is too small"));
  EXPECT_THAT(refused("  seeds: {grid: {spacing: [1, 2]}}\n"), HasSubstr("wrong number of items"));
  EXPECT_THAT(refused("  seeds: {grid: {lo: [0, 0, 2], hi: [1, 1, 1], spacing: 1}}\n  steps: 1\n"),
              StartsWith("FILE:11: trace.seeds.grid is turned round along z"));
  EXPECT_THAT(refused("  seeds: {points: [[1, 2, 3]], grid: {spacing: 1}}\n  steps: 1\n"),
              StartsWith("FILE:11: the seeds are given in more than one way"));
  EXPECT_THAT(refused("  seeds: {particles: {ids: [1], every: 2}}\n  steps: 1\n"),
              StartsWith("FILE:11: the particles are given in two ways"));
}

TEST(TraceSection, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](const std::string& more) { return refusal(with_trace(points + more)); };
  EXPECT_THAT(refused(""), HasSubstr("FILE:10: the step of the tracers is missing"));
  EXPECT_THAT(refused("  dt: 1\n  steps: 2\n"), HasSubstr("FILE:13: the step is given twice"));
  EXPECT_THAT(refused("  steps: 2\n  scheme: adaptive\n"), HasSubstr("FILE:13: the adaptive scheme needs a tolerance"));
  EXPECT_THAT(refused("  steps: 2\n  tolerance: 1\n"), HasSubstr("FILE:13: steps of rk4 have no tolerance"));
  EXPECT_THAT(refused("  through: frames\n  duration: 1\n"), HasSubstr("FILE:13: through frames, tracers move from"));
  EXPECT_THAT(refused("  through: frames\n  steps: 2\n"), HasSubstr("FILE:13: through frames, steps are not counted"));
  EXPECT_THAT(refusal(with_trace(points + "  through: frames\n  direction: backward\n"), {"input.on_error=skip_frame"}),
              HasSubstr("FILE:13: frames that may be left out"));
  EXPECT_THAT(refused("  steps: 2\naverage: {window: 3}\n"),
              HasSubstr("FILE:13: tracers through the mean need one mean of all frames"));
}

}  // namespace
}  // namespace grainvdb::trace_section_test
