#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <gtest/gtest.h>
#include <hwy/highway.h>
//
#include "trace/runge_kutta-inl.hpp"
//
#include "unit/trace/orifice.hpp"
#include "unit/trace/state.hpp"

namespace grainvdb::runge_kutta_test {
namespace {

using namespace HWY_NAMESPACE;  // NOLINT: the steps, for the instruction set of this build
using testing::OrificeFlow;
using testing::State;

constexpr double x0 = 6, z0 = 40, z1 = 10;
constexpr State start{{x0, 0, z0}};

TEST(RungeKutta, OrificeFlowHasTheStatedResidenceTime) {
  EXPECT_NEAR(OrificeFlow().residence(x0, z0, z1), 871.8407, 5e-5);
}

State orifice(double, const State& y) {
  return {OrificeFlow().velocity(y.x)};
}

State after_rk4(int steps) {
  const double dt = OrificeFlow().residence(x0, z0, z1) / steps;
  State y = start;
  for (int s = 0; s < steps; ++s) y = rk4_step(orifice, s * dt, y, dt);
  return y;
}

// The errors in z of physics section 6, within 20 %.
TEST(RungeKutta, ClassicMethodHasTheErrorsOfTheOrificeFlow) {
  const std::array<std::pair<int, double>, 4> expected{{{20, 1.5e-5}, {40, 1.0e-6}, {80, 6.7e-8}, {160, 4.3e-9}}};
  for (const auto& [steps, error] : expected) {
    const State y = after_rk4(steps);
    EXPECT_NEAR(std::abs(y.x[2] - z1), error, 0.2 * error) << steps << " steps";
    EXPECT_NEAR(y.x[0], OrificeFlow::x_at(y.x[2], x0, z0), 3 * error) << steps << " steps";
  }
}

// y' = y turns a step into a polynomial in dt: the methods' stability functions. With dt = 1/8 every term counts.
TEST(RungeKutta, StepsAreTheirPolynomials) {
  const auto f = [](double, const State& y) { return y; };
  const State one{{1, 0, 0}};
  constexpr double z = 0.125;
  constexpr double to_third = 1 + z * (1 + z / 2 * (1 + z / 3));
  constexpr double rounding = 1e-15;
  EXPECT_NEAR(rk4_step(f, 0, one, z).x[0], to_third + z * z * z * z / 24, rounding);
  const auto step = bogacki_shampine_step(f, 0, one, one, z);
  EXPECT_NEAR(step.y.x[0], to_third, rounding);
  EXPECT_NEAR(step.error.x[0], -z * z * z / 48 * (1 + z), rounding);
  EXPECT_EQ(step.last.x[0], step.y.x[0]);
}

/// The error of (n+1) ∫tⁿ dt from 1 to 3 in one step.
struct QuadratureErrors {
  double classic = 0, pair = 0, estimate = 0;
};
QuadratureErrors quadrature(int n) {
  const auto f = [n](double t, const State&) { return State{{(n + 1) * std::pow(t, n), 0, 0}}; };
  const double exact = std::pow(3, n + 1) - 1;
  const auto pair = bogacki_shampine_step(f, 1, State{}, f(1, State{}), 2);
  return {rk4_step(f, 1, State{}, 2).x[0] - exact, pair.y.x[0] - exact, pair.error.x[0]};
}

// Exact up to n = 3 by the classic method (Simpson's rule) and up to n = 2 by the pair, which estimates no error up to
// n = 1; no further.
TEST(RungeKutta, QuadratureIsOfTheOrderOfTheMethod) {
  constexpr double rounding = 1e-13, seen = 0.1;
  const auto exact_up_to = [&](int last, double QuadratureErrors::*error) {
    for (int n = 0; n <= last; ++n) EXPECT_NEAR(quadrature(n).*error, 0, rounding) << n;
    EXPECT_GT(std::abs(quadrature(last + 1).*error), seen);
  };
  exact_up_to(3, &QuadratureErrors::classic);
  exact_up_to(2, &QuadratureErrors::pair);
  exact_up_to(1, &QuadratureErrors::estimate);
}

// Halving the step divides errors of order 3 by 8 as the step goes to 0; a quarter more or less at these steps.
TEST(RungeKutta, PairIsOfOrderThreeInTheOrificeFlow) {
  const auto error = [](int steps) {
    const double dt = OrificeFlow().residence(x0, z0, z1) / steps;
    EmbeddedStep<State> step{start, {}, orifice(0, start)};
    for (int s = 0; s < steps; ++s) step = bogacki_shampine_step(orifice, s * dt, step.y, step.last, dt);
    return std::abs(step.y.x[2] - z1);
  };
  EXPECT_NEAR(error(40) / error(80), 8, 2);
  EXPECT_NEAR(error(80) / error(160), 8, 2);
}

// What a trilinear velocity does between voxels: one that bends at τ within the step, of which a method sees its nodes
// only. The error of the pair is at most 3.2 times its estimate, but near the few τ where the estimate passes 0.
TEST(RungeKutta, EstimateOfThePairHoldsWhereTheVelocityBends) {
  std::size_t within = 0;
  constexpr std::size_t bends = 1000;
  for (std::size_t i = 0; i < bends; ++i) {
    const double tau = (static_cast<double>(i) + 0.5) / bends;
    const auto f = [tau](double t, const State&) { return State{{std::max(t - tau, 0.0), 0, 0}}; };
    const auto step = bogacki_shampine_step(f, 0, State{}, f(0, State{}), 1);
    const double error = std::abs(step.y.x[0] - (1 - tau) * (1 - tau) / 2);
    EXPECT_LE(error, 1.0 / 32 + 1e-15);
    within += error <= 3.2 * std::abs(step.error.x[0]) ? 1 : 0;
  }
  EXPECT_GE(within, bends * 99 / 100);
}

}  // namespace
}  // namespace grainvdb::runge_kutta_test
