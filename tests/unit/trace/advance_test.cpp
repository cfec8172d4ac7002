// The vector paths against a plain one: same flows, same tracers, every instruction set.
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "grainvdb/tracers.hpp"
#include "support/random.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::advance_test {
namespace {

using testing::grid_of;
using testing::Random;
using testing::voxels_between;

constexpr double h = 0.5;
const Box box{{0, 0, 0}, {10.5, 9, 10}, {true, true, false}};

Lattice periodic_lattice() {
  Lattice lattice(h, {0.1, 0.2, 0.3});
  lattice.set_periods(box);
  return lattice;
}

/// A swirl with holes, as it is at one of two times.
std::shared_ptr<const FlowGrid> swirl(Interpolation interpolation, int when) {
  const Lattice lattice = periodic_lattice();
  const Coord first{lattice.period(0)->first, lattice.period(1)->first, -1};
  const auto topology = voxels_between(first, {first.x + 20, first.y + 17, 19}, [](const Coord& c) {
    return !(c.x == 11 && c.y > 3 && c.y < 9 && c.z < 12) && c != Coord{3, 3, 3};
  });
  const auto wave = [](double x, int axis) {
    return 2 * std::numbers::pi * x / box.hi[static_cast<std::size_t>(axis)];
  };
  const auto u = [=](const Vec3& x) {
    return Vec3{1 + std::sin(wave(x[1], 1)) + 0.2 * when, std::cos(wave(x[0], 0)) - 0.1 * when,
                0.3 * std::sin(wave(x[0], 0) + wave(x[1], 1)) + 0.02 * x[2]};
  };
  return grid_of(lattice, topology, interpolation, u, [u](const Vec3& x) { return 1 + u(x)[1]; });
}

Flow flow_of(Interpolation interpolation, bool frames) {
  return frames ? Flow(swirl(interpolation, 0), 1, swirl(interpolation, 1), 4) : Flow(swirl(interpolation, 0));
}

TracerSeeds random_seeds(std::size_t n) {
  Random random(11);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < n; ++i)
    places.push_back({random.uniform(0, 10.5), random.uniform(-9, 18), random.uniform(-0.5, 10.5)});
  return seeds_at(places);
}

/// Velocity and shear rate; nothing where the velocity is undefined.
using Rates = std::array<double, 4>;
std::optional<Rates> rates_at(const Flow& flow, double t, const Rates& y) {
  const auto a = flow.first().at({y[0], y[1], y[2]});
  const auto b = flow.second().at({y[0], y[1], y[2]});
  if (!a || !b) return std::nullopt;
  const double s = flow.steady() ? 0 : (t - flow.t0()) / (flow.t1() - flow.t0());
  Rates rates;
  for (std::size_t i = 0; i < 3; ++i) rates[i] = a->velocity[i] + s * (b->velocity[i] - a->velocity[i]);
  rates[3] = a->shear_rate + s * (b->shear_rate - a->shear_rate);
  return rates;
}

Rates plus(Rates y, double a, const Rates& k) {
  for (std::size_t i = 0; i < 4; ++i) y[i] += a * k[i];
  return y;
}

/// Why a step fails, and where it leads when it does not.
struct Outcome {
  TracerStop stop = TracerStop::moving;
  Rates y{};
};
Outcome step(const Flow& flow, double t, const Rates& y, double dt) {
  const auto k1 = rates_at(flow, t, y);
  if (!k1) return {TracerStop::left_material, y};
  const auto k2 = rates_at(flow, t + dt / 2, plus(y, dt / 2, *k1));
  if (!k2) return {TracerStop::left_material, y};
  const auto k3 = rates_at(flow, t + dt / 2, plus(y, dt / 2, *k2));
  if (!k3) return {TracerStop::left_material, y};
  const auto k4 = rates_at(flow, t + dt, plus(y, dt, *k3));
  if (!k4) return {TracerStop::left_material, y};
  Rates next = y;
  for (std::size_t i = 0; i < 4; ++i) next[i] += dt / 6 * ((*k1)[i] + 2 * (*k2)[i] + 2 * (*k3)[i] + (*k4)[i]);
  return {next[2] < box.lo[2] || next[2] > box.hi[2] ? TracerStop::left_domain : TracerStop::moving, next};
}

struct Expected {
  Rates y{};
  TracerStop stop = TracerStop::moving;
  double stop_time = std::numeric_limits<double>::quiet_NaN();
};

/// The path of one tracer, unwrapped.
Expected follow(const Flow& flow, Rates y, double from, double until, int count) {
  Expected e{y};
  if (y[2] < box.lo[2] || y[2] > box.hi[2]) return {y, TracerStop::left_domain, from};
  if (!rates_at(flow, from, y)) return {y, TracerStop::left_material, from};
  const double dt = (until - from) / count;
  for (int s = 0; s < count; ++s) {
    const double t = from + s * dt;
    Outcome next = step(flow, t, e.y, dt);
    int done = next.stop == TracerStop::moving ? 128 : 0;
    for (int piece = 64; done < 128;) {
      next = step(flow, t + dt * done / 128, e.y, dt * piece / 128);
      if (next.stop == TracerStop::moving) {
        e.y = next.y;
        done += piece;
      } else if ((piece /= 2) == 0) {
        return {e.y, next.stop, t + dt * done / 128};
      }
    }
    e.y = next.y;
  }
  return e;
}

class EveryTarget : public ::testing::TestWithParam<std::tuple<std::int64_t, Interpolation, bool>> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(std::get<0>(GetParam())); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

INSTANTIATE_TEST_SUITE_P(Targets, EveryTarget,
                         ::testing::Combine(::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                                            ::testing::Values(Interpolation::trilinear, Interpolation::tricubic),
                                            ::testing::Bool()),
                         [](const auto& param) {
                           return std::string(hwy::TargetName(std::get<0>(param.param))) +
                                  (std::get<1>(param.param) == Interpolation::trilinear ? "_trilinear" : "_tricubic") +
                                  (std::get<2>(param.param) ? "_frames" : "_mean");
                         });

double unwrapped(const Tracers& tracers, std::size_t axis, std::size_t i) {
  return tracers.state().position[axis][i] + tracers.state().image[axis][i] * box.length(static_cast<int>(axis));
}

TEST_P(EveryTarget, FollowsThePlainPath) {
  const Flow flow = flow_of(std::get<1>(GetParam()), std::get<2>(GetParam()));
  const TracerSeeds seeds = random_seeds(203);  // no whole number of groups
  constexpr int count = 30;
  Tracers tracers(seeds, box, flow, 1, {.stepping = FixedSteps{0.1}});
  const AdvanceReport report = tracers.advance(flow, 4);
  std::array<std::size_t, 4> stopped{};
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const Expected e = follow(flow, {seeds.position[0][i], seeds.position[1][i], seeds.position[2][i], 0}, 1, 4, count);
    // 120 steps of magnitude 20 and strains below 10, each rounded a few times, in a flow that shears them apart by
    // less than exp(3·1.5).
    constexpr double rounding = 1e-12;
    ASSERT_EQ(tracers.state().stop[i], e.stop) << i;
    ++stopped[static_cast<std::size_t>(e.stop)];
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(unwrapped(tracers, a, i), e.y[a], rounding) << i;
    EXPECT_NEAR(tracers.state().strain[i], e.y[3], rounding) << i;
    if (e.stop == TracerStop::moving) {
      EXPECT_TRUE(std::isnan(tracers.state().stop_time[i]));
    } else {
      EXPECT_NEAR(tracers.state().stop_time[i], e.stop_time, 1e-14);
    }
  }
  EXPECT_EQ(report.moving, stopped[0]);
  for (const TracerStop stop : {TracerStop::moving, TracerStop::left_material, TracerStop::left_domain})
    EXPECT_GT(stopped[static_cast<std::size_t>(stop)], 10u) << name_of(stop);
}

// Against so many equal steps that their error is below 1e-6: at the bends between voxels it is of order 2. There
// errors of the adaptive steps are up to 3.2 tolerances; neighbours part by exp(1.5) in the time of the test, and so do
// errors.
TEST_P(EveryTarget, AdaptiveStepsAddUpToTheirTolerances) {
  const Flow flow = flow_of(std::get<1>(GetParam()), std::get<2>(GetParam()));
  const TracerSeeds seeds = random_seeds(60);
  constexpr double tolerance = 1e-7;
  Tracers adaptive(seeds, box, flow, 1, {.stepping = AdaptiveSteps{tolerance}});
  Tracers fixed(seeds, box, flow, 1, {.stepping = FixedSteps{5e-4}});
  const AdvanceReport report = adaptive.advance(flow, 2);
  fixed.advance(flow, 2);
  const double bound = 3.2 * tolerance * std::exp(1.5) * static_cast<double>(report.steps) / 60;
  EXPECT_LT(bound, 1e-4);
  std::size_t moving = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    ASSERT_EQ(adaptive.state().stop[i], fixed.state().stop[i]) << i;
    // At the edge both stop within their own steps of it.
    if (fixed.state().stop[i] != TracerStop::moving) continue;
    ++moving;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(unwrapped(adaptive, a, i), unwrapped(fixed, a, i), bound) << i;
    EXPECT_NEAR(adaptive.state().strain[i], fixed.state().strain[i], bound / h) << i;
  }
  EXPECT_GT(moving, 20u);
}

}  // namespace
}  // namespace grainvdb::advance_test
