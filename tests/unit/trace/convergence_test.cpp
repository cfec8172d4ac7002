// Order of the classic method through sampled grids, down to the floor of interpolation.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>
//
#include "trace/runge_kutta-inl.hpp"
//
#include "grainvdb/tracers.hpp"
#include "unit/trace/fields.hpp"
#include "unit/trace/orifice.hpp"
#include "unit/trace/state.hpp"

namespace grainvdb::convergence_test {
namespace {

using testing::grid_of;
using testing::open_box;
using testing::OrificeFlow;
using testing::State;
using testing::voxels_between;

constexpr double x0 = 6, z0 = 40, z1 = 10;
constexpr std::array<int, 5> step_counts{5, 10, 20, 40, 80};
constexpr int enough = 2560;  // steps whose own error is far below that of any grid

double residence() {
  return OrificeFlow().residence(x0, z0, z1);
}

/// The orifice flow around the path, on voxels of size h.
Flow orifice(double h, Interpolation interpolation) {
  const Lattice lattice(h, {0, 0, 0});
  const auto at = [h](double x) { return static_cast<std::int32_t>(x / h); };
  const auto topology = voxels_between({at(3) - 2, 0, at(10) - 3}, {at(6) + 2, 4, at(40) + 2});
  return Flow(grid_of(lattice, topology, interpolation, [](const Vec3& x) { return OrificeFlow().velocity(x); }));
}

/// The error in z after the residence time.
double error_through(const Flow& flow, int steps) {
  const double h = flow.first().lattice().voxel();
  Tracers tracers(seeds_at(std::vector<Vec3>{{x0, 2.5 * h, z0}}), open_box({0, 0, 0}, {50, 50, 50}), flow, 0,
                  {.stepping = FixedSteps{residence() / steps}});
  EXPECT_EQ(tracers.advance(flow, residence()).steps, static_cast<std::size_t>(steps));
  return tracers.state().position[2][0] - z1;
}

/// The same with the velocity itself.
double error_of_steps(int steps) {
  const auto velocity = [](double, const State& y) { return State{OrificeFlow().velocity(y.x)}; };
  const double dt = residence() / steps;
  State y{{x0, 0, z0}};
  for (int s = 0; s < steps; ++s) y = HWY_NAMESPACE::rk4_step(velocity, s * dt, y, dt);
  return y.x[2] - z1;
}

// Rounding of the velocity to float. It could add up to 3.6e-6, 2⁻²⁴ of a path of 30 amplified by (40/10)^½, but
// differs in sign from voxel to voxel: this is what is left, measured below 1e-7.
constexpr double float_floor = 2e-7;

// With many steps an error of order 2 remains: halving the voxels divides it by 4.
TEST(Convergence, TrilinearFloorIsOfOrderTwo) {
  double before = error_through(orifice(1, Interpolation::trilinear), enough);
  for (const double h : {0.5, 0.25, 0.125, 0.0625}) {
    const double floor = error_through(orifice(h, Interpolation::trilinear), enough);
    EXPECT_NEAR(before / floor, 4, 0.2) << h;
    before = floor;
  }
  EXPECT_NEAR(before, 1.08e-4, 0.05e-4);
}

// Errors of splines within a cell cancel on the way through it, so that more than their order 3 remains.
TEST(Convergence, TricubicFloorIsOfOrderThreeAtLeast) {
  double before = error_through(orifice(1, Interpolation::tricubic), enough);
  for (const double h : {0.5, 0.25, 0.125, 0.0625}) {
    const double floor = error_through(orifice(h, Interpolation::tricubic), enough);
    EXPECT_LE(std::abs(floor), std::abs(before) / 8 + float_floor) << h;
    before = floor;
  }
}

/// The largest error of the sampled velocity along the path.
double sampling_error(const Flow& flow) {
  const double h = flow.first().lattice().voxel();
  double worst = 0;
  for (double z = z1; z <= z0; z += 0.01) {
    const Vec3 x{OrificeFlow::x_at(z, x0, z0), 2.5 * h, z};
    const Vec3 sampled = flow.first().at(x)->velocity, exact = OrificeFlow().velocity(x);
    for (std::size_t a = 0; a < 3; ++a) worst = std::max(worst, std::abs(sampled[a] - exact[a]));
  }
  return worst;
}

// The error is that of the method, known from the velocity itself and of order 4, plus what the sampled velocity is out
// by over the residence time, in x and in z; errors in z grow by (40/10)^½ on the way.
TEST(Convergence, StepsThroughGridsHaveTheErrorsOfTheMethodDownToTheFloor) {
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic})
    for (const double h : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
      const Flow flow = orifice(h, interpolation);
      const double bound = 2 * residence() * sampling_error(flow);
      for (const int steps : step_counts)
        EXPECT_NEAR(error_through(flow, steps), error_of_steps(steps), bound) << h << ", " << steps << " steps";
      if (interpolation == Interpolation::tricubic && h < 0.2) {  // the order shows above this floor
        EXPECT_LT(bound, std::abs(error_of_steps(20)));
      }
    }
}

// The figures of physics section 6, until rounding hides them.
TEST(Convergence, FineGridsGiveTheErrorsOfTheOrificeFlow) {
  const Flow flow = orifice(0.125, Interpolation::tricubic);
  EXPECT_NEAR(std::abs(error_through(flow, 20)), 1.5e-5, 0.2 * 1.5e-5);
  EXPECT_NEAR(std::abs(error_through(flow, 40)), 1.0e-6, 0.2 * 1.0e-6);
  EXPECT_NEAR(std::abs(error_through(flow, 80)), 6.7e-8, float_floor);
}

}  // namespace
}  // namespace grainvdb::convergence_test
