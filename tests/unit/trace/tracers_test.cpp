#include "grainvdb/tracers.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/random.hpp"
#include "unit/trace/fields.hpp"
#include "unit/trace/tracers_scene.hpp"

namespace grainvdb::tracers_test {
namespace {

using testing::grid_of;
using ::testing::HasSubstr;
using testing::open_box;
using testing::Random;
using ::testing::ThrowsMessage;
using testing::voxels_between;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;
constexpr auto trilinear = Interpolation::trilinear;
constexpr auto tricubic = Interpolation::tricubic;
using testing::position;
using testing::seed;
using testing::unit_lattice;

TEST(Tracers, UniformFlowMovesThemStraight) {
  const auto topology = voxels_between({0, 0, 0}, {39, 7, 7});
  const Box box = open_box({0, 0, 0}, {40, 8, 8});
  for (const Interpolation interpolation : {trilinear, tricubic}) {
    const Flow flow(grid_of(unit_lattice, topology, interpolation, [](const Vec3&) { return Vec3{2, 0.125, 0}; }));
    for (const auto& stepping :
         {TracerSettings{.stepping = FixedSteps{0.3}}, TracerSettings{.stepping = AdaptiveSteps{1e-6}}}) {
      Tracers tracers(seed({3, 3, 3}), box, flow, 5, stepping);
      EXPECT_EQ(tracers.advance(flow, 17).moving, 1u);
      const Vec3 x = position(tracers);
      EXPECT_NEAR(x[0], 27, 1e-13);
      EXPECT_NEAR(x[1], 4.5, 1e-13);
      EXPECT_EQ(x[2], 3);
      EXPECT_EQ(tracers.time(), 17);
    }
  }
}

// Voxel 20 along x is missing, so that the last cell ends at the centre of voxel 19.
TEST(Tracers, StopAtAHoleWithTheLastGoodPlace) {
  const auto topology = voxels_between({0, 0, 0}, {39, 7, 7}, [](const Coord& c) { return c.x != 20; });
  const Flow flow(grid_of(
      unit_lattice, topology, trilinear,
      [](const Vec3&) {
        return Vec3{2, 0, 0};
      },
      [](const Vec3&) { return 0.5; }));
  const Box box = open_box({0, 0, 0}, {40, 8, 8});
  constexpr double edge = 19.5, start = 3, dt = 0.3;
  Tracers fixed(seed({start, 3, 3}), box, flow, 0, {.stepping = FixedSteps{dt}});
  Tracers adaptive(seed({start, 3, 3}), box, flow, 0, {.stepping = AdaptiveSteps{1e-6}});
  const auto expect_stopped = [&](const Tracers& tracers, double within) {
    const TracerState& s = tracers.state();
    EXPECT_EQ(s.stop[0], TracerStop::left_material);
    EXPECT_LT(s.position[0][0], edge);
    EXPECT_GE(s.position[0][0], edge - within);
    EXPECT_NEAR(s.stop_time[0], (s.position[0][0] - start) / 2, 1e-13);
    EXPECT_NEAR(s.strain[0], 0.5 * s.stop_time[0], 1e-13);
  };
  EXPECT_EQ(fixed.advance(flow, 6).moving, 1u);
  EXPECT_EQ(fixed.advance(flow, 12).moving, 0u);
  expect_stopped(fixed, 2 * dt / 128);
  EXPECT_EQ(adaptive.advance(flow, 12).moving, 0u);
  expect_stopped(adaptive, 1.0 / 128);
  const TracerState before = fixed.state();
  const AdvanceReport report = fixed.advance(flow, 13);
  EXPECT_EQ(report.steps, 0u);
  EXPECT_EQ(fixed.state().position, before.position);
  EXPECT_EQ(fixed.state().stop_time, before.stop_time);
}

TEST(Tracers, StopAtOpenSides) {
  const auto topology = voxels_between({-3, -3, -3}, {12, 12, 12});  // kernels reach beyond the box
  const Box box = open_box({0, 0, 0}, {10, 10, 10});
  for (const double direction : {-1.0, 1.0}) {
    const Flow flow(grid_of(unit_lattice, topology, trilinear, [=](const Vec3&) { return Vec3{0, direction, 0}; }));
    Tracers fixed(seed({5, 5, 5}), box, flow, 0, {.stepping = FixedSteps{0.35}});
    Tracers adaptive(seed({5, 5, 5}), box, flow, 0, {.stepping = AdaptiveSteps{1e-3}});
    for (Tracers* tracers : {&fixed, &adaptive}) {
      tracers->advance(flow, 7);
      EXPECT_EQ(tracers->state().stop[0], TracerStop::left_domain);
      const double gone = direction * (position(*tracers)[1] - 5);
      EXPECT_LE(gone, 5);
      EXPECT_GE(gone, 5 - 1.0 / 128);
      EXPECT_NEAR(tracers->state().stop_time[0], gone, 1e-13);
    }
  }
}

TEST(Tracers, SeedsInNoMaterialAreKeptWithTheirCode) {
  const auto topology = voxels_between({0, 0, 0}, {7, 7, 7});
  const Flow flow(grid_of(unit_lattice, topology, trilinear, [](const Vec3&) { return Vec3{1, 0, 0}; }));
  const std::vector<Vec3> places{{4, 4, 4}, {0.25, 4, 4}, {4, 20, 4}, {4, 4, 9}};
  Tracers tracers(seeds_at(places), open_box({0, 0, 0}, {10, 10, 8}), flow, 2, {.stepping = FixedSteps{1}});
  const TracerState& s = tracers.state();
  using enum TracerStop;
  EXPECT_THAT(s.stop, ::testing::ElementsAre(moving, left_material, left_domain, left_domain));
  EXPECT_EQ(tracers.advance(flow, 3).moving, 1u);
  EXPECT_EQ(position(tracers, 0)[0], 5);
  for (std::size_t i = 1; i < places.size(); ++i) {
    EXPECT_EQ(position(tracers, i), places[i]);
    EXPECT_EQ(s.stop_time[i], 2);
  }
}

Lattice periodic_lattice(const Box& box, double h) {
  Lattice lattice(h, {0, 0, 0});
  lattice.set_periods(box);
  return lattice;
}

// One period of 10 by 15 by 20, crossed 3, -2 and 1 times, into either direction.
TEST(Tracers, PeriodicFlowReturnsToItsStart) {
  const Box box{{-1, 2, 0}, {9, 17, 20}, {true, true, true}};
  const Lattice lattice = periodic_lattice(box, 0.5);
  const Coord first{lattice.period(0)->first, lattice.period(1)->first, lattice.period(2)->first};
  const auto topology = voxels_between(first, {first.x + 19, first.y + 29, first.z + 39});
  const Flow flow(grid_of(lattice, topology, trilinear, [](const Vec3&) { return Vec3{3, -3, 2}; }));
  Random random(5);
  std::vector<Vec3> places;
  for (int i = 0; i < 50; ++i) places.push_back({random.uniform(-1, 9), random.uniform(2, 17), random.uniform(0, 20)});
  for (const auto& settings :
       {TracerSettings{.stepping = FixedSteps{0.37}}, TracerSettings{.stepping = AdaptiveSteps{1e-6}}}) {
    Tracers tracers(seeds_at(places), box, flow, 0, settings);
    tracers.advance(flow, 4);
    EXPECT_EQ(tracers.advance(flow, 10).moving, places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::array<int, 3> images{3, -2, 1};
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_NEAR(position(tracers, i)[a], places[i][a], 1e-12);
        EXPECT_EQ(tracers.state().image[a][i], images[a]);
      }
    }
  }
}

TEST(Tracers, SeedsOutsideAPeriodicBoxKeepTheirImage) {
  const Box box{{0, 0, 0}, {10, 8, 8}, {true, false, false}};
  const Lattice lattice = periodic_lattice(box, 1);
  const Flow flow(grid_of(lattice, voxels_between({0, 0, 0}, {9, 7, 7}), trilinear, [](const Vec3&) {
    return Vec3{1, 0, 0};
  }));
  Tracers tracers(seeds_at(std::vector<Vec3>{{-3, 4, 4}, {37.5, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{1}});
  EXPECT_THAT(tracers.state().image[0], ::testing::ElementsAre(-1, 3));
  EXPECT_THAT(tracers.state().position[0], ::testing::ElementsAre(7, 7.5));
  tracers.advance(flow, 5);
  EXPECT_THAT(tracers.state().image[0], ::testing::ElementsAre(0, 4));
  EXPECT_THAT(tracers.state().position[0], ::testing::ElementsAre(2, 2.5));
  EXPECT_THAT(tracers.state().seed[0], ::testing::ElementsAre(-3, 37.5));
}

/// Rigid rotation about the axis (10, 10, ·).
Vec3 rotation(const Vec3& x) {
  return {-(x[1] - 10), x[0] - 10, 0};
}

// A step of angle θ multiplies the complex radius by 1 + iθ - θ²/2 - iθ³/6 + θ⁴/24, of magnitude 1 - θ⁶/144 and
// argument θ - θ⁵/120 to the first order: after a full turn the radius has lost 2π θ⁵/144 of itself and the angle 2π
// θ⁴/120. Rounding the velocity to float adds 2⁻²⁴ of the largest speed around, times the duration 2π.
TEST(Tracers, FullTurnOfARigidRotationConservesTheRadius) {
  const auto topology = voxels_between({0, 0, 0}, {19, 19, 3});
  const Box box = open_box({0, 0, 0}, {20, 20, 4});
  for (const Interpolation interpolation : {trilinear, tricubic}) {
    const Flow flow(grid_of(unit_lattice, topology, interpolation, rotation, [](const Vec3&) { return 0.0; }));
    for (const int steps : {50, 100, 400})
      for (const double radius : {0.7, 3.0, 8.0}) {
        const double theta = 2 * pi / steps;
        Tracers tracers(seed({10 + radius, 10, 2}), box, flow, 0, {.stepping = FixedSteps{theta}});
        const AdvanceReport report = tracers.advance(flow, 2 * pi);
        EXPECT_EQ(report.steps, static_cast<std::size_t>(steps));
        const double float_rounding = 2 * pi * 0x1p-24 * std::sqrt(2) * (radius + 2);
        const Vec3 x = position(tracers);
        const double lost = 2 * pi * std::pow(theta, 5) / 144 * radius;
        EXPECT_NEAR(std::hypot(x[0] - 10, x[1] - 10), radius - lost, 0.1 * lost + float_rounding);
        EXPECT_NEAR(x[1] - 10, -2 * pi * std::pow(theta, 4) / 120 * radius, 0.1 * lost / theta + float_rounding);
        EXPECT_EQ(x[2], 2);
        EXPECT_EQ(tracers.state().strain[0], 0);
      }
  }
}

// The velocity is linear in space: nothing bends, errors of steps neither grow nor shrink on their way. They add up
// along the same circle, so that most of what is allowed is used.
TEST(Tracers, AdaptiveStepsMeetTheirTolerance) {
  const auto topology = voxels_between({0, 0, 0}, {19, 19, 3});
  const Flow flow(grid_of(unit_lattice, topology, trilinear, rotation));
  for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
    Tracers tracers(seed({15, 10, 2}), open_box({0, 0, 0}, {20, 20, 4}), flow, 0,
                    {.stepping = AdaptiveSteps{tolerance}});
    const AdvanceReport report = tracers.advance(flow, 2 * pi);
    const double error = std::hypot(position(tracers)[0] - 15, position(tracers)[1] - 10);
    const double allowed = std::sqrt(2) * tolerance * static_cast<double>(report.steps);
    EXPECT_LE(error, allowed) << tolerance;
    EXPECT_GE(error, 0.01 * allowed) << tolerance;
    EXPECT_LE(report.rejected, report.steps / 5);
  }
}

TEST(Tracers, AdaptiveStepsAreNoLongerThanAsked) {
  const auto topology = voxels_between({0, 0, 0}, {39, 7, 7});
  const Flow flow(grid_of(unit_lattice, topology, trilinear, [](const Vec3&) { return Vec3{1, 0, 0}; }));
  Tracers tracers(seed({2, 4, 4}), open_box({0, 0, 0}, {40, 8, 8}), flow, 0,
                  {.stepping = AdaptiveSteps{.tolerance = 1, .longest = 0.25}, .step_numbers = true});
  EXPECT_GE(tracers.advance(flow, 10).steps, 40u);
  EXPECT_NEAR(tracers.state().courant[0], 0.25, 1e-15);
}

// Stages of a step of half a radian lie up to 12 % farther out than the circle, beyond the material; the path does not.
TEST(Tracers, StagesOutsideTheMaterialDoNotStopTheTracer) {
  const auto inside = [](const Coord& c) { return std::hypot(c.x + 0.5 - 10, c.y + 0.5 - 10) < 8; };
  const Flow flow(grid_of(unit_lattice, voxels_between({0, 0, 0}, {19, 19, 3}, inside), trilinear, rotation));
  constexpr double radius = 6.2;  // a cell's diagonal within the rim
  for (const auto& settings :
       {TracerSettings{.stepping = FixedSteps{0.5}}, TracerSettings{.stepping = AdaptiveSteps{1e-2}}}) {
    Tracers tracers(seed({10 + radius, 10, 2}), open_box({0, 0, 0}, {20, 20, 4}), flow, 0, settings);
    tracers.advance(flow, 2 * pi);
    EXPECT_EQ(tracers.state().stop[0], TracerStop::moving);
    EXPECT_NEAR(std::hypot(position(tracers)[0] - 10, position(tracers)[1] - 10), radius, 0.2);
  }
}

TEST(Tracers, HaveTheSameBytesForAnyNumberOfThreads) {
  const Box box{{0, 0, 0}, {20, 20, 20}, {true, true, false}};
  const Lattice lattice = periodic_lattice(box, 1);
  const auto topology =
      voxels_between({0, 0, 0}, {19, 19, 19}, [](const Coord& c) { return c.x < 12 || c.y < 9 || c.z > 4; });
  const auto u = [](const Vec3& x) {
    return Vec3{1 + std::sin(pi * x[1] / 10), std::cos(pi * x[0] / 10), 0.2 * std::sin(pi * x[0] / 10)};
  };
  const Flow flow(grid_of(lattice, topology, trilinear, u, [](const Vec3& x) { return x[0]; }));
  Random random(9);
  std::vector<Vec3> places;
  for (int i = 0; i < 3001; ++i)
    places.push_back({random.uniform(0, 20), random.uniform(0, 20), random.uniform(0, 20)});
  const auto run = [&](const TracerSettings& settings, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Tracers tracers(seeds_at(places), box, flow, 0, settings);
    tracers.advance(flow, 5);
    std::vector<double> all = tracers.state().strain;
    for (const auto* column : {&tracers.state().position[0], &tracers.state().position[1], &tracers.state().position[2],
                               &tracers.state().stop_time, &tracers.state().courant})
      all.insert(all.end(), column->begin(), column->end());
    return all;
  };
  for (const auto& settings : {TracerSettings{.stepping = FixedSteps{0.1}, .step_numbers = true},
                               TracerSettings{.stepping = AdaptiveSteps{1e-4}, .step_numbers = true}}) {
    const std::vector<double> one = run(settings, 1);
    for (const std::size_t threads : {2, 3, 8}) {
      const std::vector<double> several = run(settings, threads);
      EXPECT_EQ(std::memcmp(one.data(), several.data(), one.size() * sizeof(double)), 0) << threads;
    }
  }
}

TEST(Tracers, RefuseWhatCannotBeMeant) {
  const auto topology = voxels_between({0, 0, 0}, {7, 7, 7});
  const auto grid = grid_of(unit_lattice, topology, trilinear, [](const Vec3&) { return Vec3{1, 0, 0}; });
  const Flow flow(grid);
  const Box box = open_box({0, 0, 0}, {8, 8, 8});
  const TracerSettings good{.stepping = FixedSteps{1}};
  const auto make = [&](const TracerSeeds& seeds, const TracerSettings& settings) {
    return Tracers(seeds, box, flow, 0, settings);
  };
  const auto message = [](const char* text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); };
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    EXPECT_THAT(
        [&] {
          make(seed({4, 4, 4}), {.stepping = FixedSteps{bad}});
        },
        message("step of tracers must be positive"));
    EXPECT_THAT(
        [&] {
          make(seed({4, 4, 4}), {.stepping = AdaptiveSteps{bad}});
        },
        message("tolerance of tracers must be positive"));
  }
  for (const double bad : {0.0, -1.0, nan})
    EXPECT_THAT(
        [&] {
          make(seed({4, 4, 4}), {.stepping = AdaptiveSteps{1, bad}});
        },
        message("longest step of tracers must be positive"));
  EXPECT_THAT([&] { make({}, good); }, message("no seeds"));
  TracerSeeds seeds = seed({4, 4, 4});
  for (const double bad : {nan, infinity}) {
    seeds.position[1][0] = bad;
    EXPECT_THAT([&] { make(seeds, good); }, message("tracer 1 must be finite"));
    EXPECT_THAT([&] { Tracers(seed({4, 4, 4}), box, flow, bad, good); }, message("time at which tracers start"));
  }
  Box periodic = box;
  periodic.periodic[2] = true;
  EXPECT_THAT([&] { Tracers(seed({4, 4, 4}), periodic, flow, 0, good); }, message("periods of their box"));

  Tracers tracers = make(seed({4, 4, 4}), good);
  for (const double until : {0.0, -1.0, nan, infinity})
    EXPECT_THAT([&] { tracers.advance(flow, until); }, message("moved on to a later time"));
  const Flow frames(grid, 0, grid, 1), later(grid, 0.5, grid, 3);
  EXPECT_THAT([&] { tracers.advance(frames, 1.5); }, message("between the two frames"));
  EXPECT_THAT([&] { tracers.advance(later, 1); }, message("between the two frames"));
  Tracers late(seed({4, 4, 4}), box, flow, 1e9, {.stepping = FixedSteps{1e-8}});
  EXPECT_THAT([&] { late.advance(flow, 1.1e9); }, message("vanishes in the rounding of their time"));
  EXPECT_EQ(tracers.time(), 0);
}

}  // namespace
}  // namespace grainvdb::tracers_test
