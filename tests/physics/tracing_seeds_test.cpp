// Where tracers start, and which part of the grids is splatted for them.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"
#include "physics/tracing_scene.hpp"
#include "support/lattice_packing.hpp"
#include "support/memory_source.hpp"
#include "support/memory_tracers.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::tracing_seeds_test {
namespace {

using namespace testing::tracing_scene;  // NOLINT: what the tests of this scene share

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A flow that turns and crosses the boundaries of a box many leaves wide.
std::vector<Frame> wide_frames() {
  const double k = 2 * M_PI / many_sites;
  std::vector<Frame> frames;
  for (int t = 0; t < 4; ++t) {
    frames.push_back(cubic_packing(many_sites, true, [&](const Vec3& x) {
      return Vec3{0.6 + 0.1 * t, 0.3 * std::sin(k * x[0]), 0.2 * std::cos(k * x[1])};
    }));
    frames.back().time = t;
    frames.back().step = t;
  }
  return frames;
}

TEST(TraceNeighbourhood, GivesTheSameBytesAsWholeGridsAndSplatsLess) {
  using Neighbourhood = TraceSpec::Neighbourhood;
  const auto frames = wide_frames();
  // In a box of three leaves along each side, what is needed of a long way may lie within reach of every particle.
  const auto both = [&](Pipeline p, double most_particles) {
    p.trace->record = {"phi", "shear_rate"};
    p.trace->neighbourhood = Neighbourhood::never;
    const Histories whole = trace(p, frames);
    p.trace->neighbourhood = Neighbourhood::always;
    const Histories nearby = trace(p, frames);
    EXPECT_TRUE(same_histories(whole, nearby));
    EXPECT_LT(nearby.report.summed_leaves, whole.report.summed_leaves);
    EXPECT_EQ(whole.report.trace->nearby_passes, 0U);
    EXPECT_LE(nearby.report.trace->nearby_share, most_particles);
    EXPECT_THAT(nearby.provenance_text("trace"), HasSubstr("splatted around the tracers alone, in "));
    return nearby.report.trace->nearby_passes;
  };
  // 30 lengths, once around the box and further: longer than the first neighbourhood, and than the first way.
  EXPECT_GT(both(through_mean({{3, 12, 12}}, 40, 0.25), 1), 1U);
  EXPECT_EQ(both(through_mean({{3, 12, 12}, {4, 12, 12}}, 1, 0.25), 0.9), 1U);  // stays near
  EXPECT_GE(both(through_frames({{3, 12, 12}}), 0.9), 2U);
  Pipeline p = through_mean({{22, 2, 23}}, 8, 0.25);
  p.trace->interpolation = Interpolation::tricubic;
  p.trace->direction = TraceSpec::Direction::backward;
  p.trace->scheme = TraceSpec::Scheme::adaptive;
  p.trace->tolerance = 1e-4;
  both(p, 0.9);
}

TEST(TraceNeighbourhood, IsChosenByCost) {
  const auto frames = wide_frames();
  Pipeline p = through_mean({{3, 12, 12}}, 1, 0.25);
  p.trace->strain = false;
  EXPECT_EQ(trace(p, frames).report.trace->nearby_passes, 1U);  // c/h = 4: 268 values, and a third of the box
  p.trace->seeds.points = {{3, 12, 12}, {12, 12, 3}, {20, 12, 20}};
  EXPECT_EQ(trace(p, frames).report.trace->nearby_passes, 0U);
  p.trace->seeds.points = {{3, 12, 12}};
  p.fields = {"phi"};
  EXPECT_EQ(trace(p, frames).report.trace->nearby_passes, 0U);  // whole grids are wanted anyway
}

TEST(TraceSeeds, LieOnAGridOverTheBox) {
  Pipeline p = through_mean({}, 1, 0.5);
  constexpr double side = HUGE_VAL;
  p.trace->seeds.grid = {{-side, 2, -side}, {side, 2, side}, {4, 1, 2}};
  const Histories h = trace(p, frames_of(uniform, {0, 1}));
  ASSERT_EQ(h.layout.id.size(), 2U * 4U);
  const auto& x = h.samples[0].position;
  EXPECT_EQ((Vec3{x[0][0], x[1][0], x[2][0]}), (Vec3{1.5, 2, 0.5}));
  EXPECT_EQ((Vec3{x[0][7], x[1][7], x[2][7]}), (Vec3{5.5, 2, 6.5}));
}

TEST(TraceSeeds, LieOnParticlesOfTheFirstFrame) {
  auto frames = frames_of(uniform, {0, 1, 2});
  frames[0].particles.position[0][9] += 0.25;
  frames[2].particles.position[1][9] += 0.25;
  Pipeline p = through_mean({}, 1, 0.5);
  p.trace->seeds.particles = {{10, 3}, 1};
  const Histories h = trace(p, frames);
  EXPECT_THAT(h.layout.id, ElementsAre(3, 10));
  EXPECT_EQ(h.samples[0].position[0][1], frames[0].particles.position[0][9]);
  p.trace->through = TraceSpec::Through::frames;
  p.trace->direction = TraceSpec::Direction::backward;
  p.window = 1;
  const Histories back = trace(p, frames);
  EXPECT_EQ(back.samples[0].position[1][1], frames[2].particles.position[1][9]);
  p.trace->seeds.particles = {{}, 100};
  EXPECT_THAT(trace(p, frames).layout.id, ElementsAre(1, 101, 201, 301, 401, 501));
  p.select.ids = {{150, 200}};
  EXPECT_THAT(trace(p, frames).layout.id, ElementsAre(150));
}

}  // namespace
}  // namespace grainvdb::testing::tracing_seeds_test
