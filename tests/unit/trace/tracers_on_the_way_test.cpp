// What tracers gather on their way, and frames that they move through.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/tracers.hpp"
#include "support/random.hpp"
#include "unit/trace/fields.hpp"
#include "unit/trace/tracers_scene.hpp"

namespace grainvdb::tracers_on_the_way_test {
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

TEST(Tracers, StrainOfSimpleShearIsRateTimesTime) {
  constexpr double rate = 0.75;
  const auto topology = voxels_between({0, 0, 0}, {39, 7, 7});
  const Flow flow(grid_of(
      unit_lattice, topology, trilinear,
      [](const Vec3& x) {
        return Vec3{rate * x[1], 0, 0};
      },
      [](const Vec3&) { return rate; }));
  for (const auto& settings :
       {TracerSettings{.stepping = FixedSteps{0.1}}, TracerSettings{.stepping = AdaptiveSteps{1e-6}}}) {
    Tracers tracers(seed({2, 4, 4}), open_box({0, 0, 0}, {40, 8, 8}), flow, 1, settings);
    tracers.advance(flow, 3);
    tracers.advance(flow, 11);
    EXPECT_NEAR(tracers.state().strain[0], rate * 10, 1e-13);
    EXPECT_NEAR(position(tracers)[0], 2 + rate * 4 * 10, 1e-12);
  }
}

// ∫ |γ̇| dt with a rate that grows linearly along the way.
TEST(Tracers, StrainIsIntegratedAlongTheWay) {
  const auto topology = voxels_between({0, 0, 0}, {39, 7, 7});
  const Flow flow(grid_of(
      unit_lattice, topology, trilinear,
      [](const Vec3&) {
        return Vec3{2, 0, 0};
      },
      [](const Vec3& x) { return 0.5 * x[0]; }));
  Tracers tracers(seed({1, 4, 4}), open_box({0, 0, 0}, {40, 8, 8}), flow, 0, {.stepping = FixedSteps{0.7}});
  tracers.advance(flow, 10);
  EXPECT_NEAR(tracers.state().strain[0], 0.5 * (1 * 10 + 100), 1e-12);
}

// u = (1 + t, 2 - t/2, 0) between frames at 0, 2 and 5: x = t + t²/2, y = 2t - t²/4, exactly but for rounding.
TEST(Tracers, FramesThatChangeLinearlyAreExact) {
  const auto topology = voxels_between({0, 0, 0}, {31, 31, 7});
  const auto frame = [&](double t, Interpolation interpolation) {
    return grid_of(
        unit_lattice, topology, interpolation,
        [t](const Vec3&) {
          return Vec3{1 + t, 2 - t / 2, 0};
        },
        [t](const Vec3&) { return t; });
  };
  for (const Interpolation interpolation : {trilinear, tricubic})
    for (const auto& settings :
         {TracerSettings{.stepping = FixedSteps{0.9}}, TracerSettings{.stepping = AdaptiveSteps{1e-3}}}) {
      const Flow early(frame(0, interpolation), 0, frame(2, interpolation), 2);
      const Flow late(frame(2, interpolation), 2, frame(5, interpolation), 5);
      Tracers tracers(seed({1, 1, 4}), open_box({0, 0, 0}, {32, 32, 8}), Flow(frame(0, interpolation)), 0, settings);
      tracers.advance(early, 1.5);
      tracers.advance(early, 2);
      tracers.advance(late, 5);
      EXPECT_NEAR(position(tracers)[0], 1 + 5 + 12.5, 2e-13);
      EXPECT_NEAR(position(tracers)[1], 1 + 10 - 6.25, 2e-13);
      EXPECT_NEAR(tracers.state().strain[0], 12.5, 2e-13);
    }
}

TEST(Tracers, FramesNeedMaterialInBoth) {
  const auto all = voxels_between({0, 0, 0}, {15, 7, 7});
  const auto half = voxels_between({0, 0, 0}, {7, 7, 7});
  const auto u = [](const Vec3&) { return Vec3{1, 0, 0}; };
  const auto first = grid_of(unit_lattice, all, trilinear, u), second = grid_of(unit_lattice, half, trilinear, u);
  const Flow flow(first, 0, second, 10);
  Tracers tracers(seeds_at(std::vector<Vec3>{{2, 4, 4}, {10, 4, 4}}), open_box({0, 0, 0}, {16, 8, 8}), Flow(first), 0,
                  {.stepping = FixedSteps{0.5}});
  tracers.advance(flow, 8);
  EXPECT_EQ(tracers.state().stop[0], TracerStop::left_material);
  EXPECT_NEAR(position(tracers, 0)[0], 7.5, 0.5 / 128);
  EXPECT_EQ(position(tracers, 1)[0], 10);
  EXPECT_EQ(tracers.state().stop_time[1], 0);
}

TEST(Tracers, UndefinedShearRateStopsThemOrNot) {
  const auto topology = voxels_between({0, 0, 0}, {15, 7, 7});
  const Flow flow(grid_of(
      unit_lattice, topology, trilinear,
      [](const Vec3&) {
        return Vec3{1, 0, 0};
      },
      [](const Vec3& x) { return x[0] > 8 ? nan : 1.0; }));
  const Box box = open_box({0, 0, 0}, {16, 8, 8});
  for (const auto& stepping :
       {TracerSettings{.stepping = FixedSteps{0.5}}, TracerSettings{.stepping = AdaptiveSteps{1e-3}}}) {
    TracerSettings settings = stepping;
    Tracers stopping(seed({2, 4, 4}), box, flow, 0, settings);
    stopping.advance(flow, 12);
    EXPECT_EQ(stopping.state().stop[0], TracerStop::masked);
    EXPECT_NEAR(position(stopping)[0], 7.5, 1.0 / 128);
    EXPECT_NEAR(stopping.state().strain[0], 5.5, 1.0 / 128);
    settings.on_undefined = OnUndefined::carry_on;
    Tracers going_on(seed({2, 4, 4}), box, flow, 0, settings);
    going_on.advance(flow, 12);
    EXPECT_EQ(going_on.state().stop[0], TracerStop::moving);
    EXPECT_NEAR(position(going_on)[0], 14, 1e-13);
    EXPECT_TRUE(std::isnan(going_on.state().strain[0]));
  }
}

// u = (4 + 3y, 0, 0) has |u| = 4 + 3y and |∇u| = 3; the spacing of the frames is 0.2, that of the steps 0.05.
TEST(Tracers, StepNumbersAreOfTheFramesOrOfTheStep) {
  const Lattice lattice(0.5, {0, 0, 0});
  const auto grid = grid_of(lattice, voxels_between({0, 0, 0}, {39, 7, 7}), tricubic, [](const Vec3& x) {
    return Vec3{4 + 3 * x[1], 0, 0};
  });
  const Box box = open_box({0, 0, 0}, {20, 4, 4});
  const TracerSeeds seeds = seeds_at(std::vector<Vec3>{{2, 1, 2}, {2, 3, 2}, {2, 1, 3}, {19.9, 3, 3}});
  const TracerSettings settings{.stepping = FixedSteps{0.05}, .step_numbers = true};
  const Flow mean(grid), frames(grid, 0, grid, 0.2);
  Tracers in_mean(seeds, box, mean, 0, settings), in_frames(seeds, box, mean, 0, settings);
  EXPECT_TRUE(std::isnan(in_mean.state().courant[0]));
  const AdvanceReport of_mean = in_mean.advance(mean, 0.1);
  const AdvanceReport of_frames = in_frames.advance(frames, 0.1);
  constexpr double rounding = 1e-5;
  for (std::size_t i = 0; i < 3; ++i) {
    const double speed = 4 + 3 * seeds.position[1][i];
    EXPECT_NEAR(in_mean.state().courant[i], speed * 0.05 / 0.5, rounding);
    EXPECT_NEAR(in_mean.state().gradient_number[i], 3 * 0.05, rounding);
    EXPECT_NEAR(in_frames.state().courant[i], speed * 0.2 / 0.5, rounding);
    EXPECT_NEAR(in_frames.state().gradient_number[i], 3 * 0.2, rounding);
  }
  EXPECT_TRUE(std::isnan(in_mean.state().courant[3]));  // it started outside the material
  EXPECT_EQ(of_mean.above_courant_limit, 1u);
  EXPECT_EQ(of_mean.above_gradient_limit, 0u);
  EXPECT_EQ(of_frames.above_courant_limit, 3u);
  EXPECT_EQ(of_frames.above_gradient_limit, 3u);
  EXPECT_TRUE(Tracers(seeds, box, mean, 0, {.stepping = FixedSteps{1}}).state().courant.empty());
}

}  // namespace
}  // namespace grainvdb::tracers_on_the_way_test
