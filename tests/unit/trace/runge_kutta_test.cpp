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

namespace grainvdb {
namespace {

using namespace HWY_NAMESPACE;  // NOLINT: the steps, for the instruction set of this build
using testing::OrificeFlow;

/// A position as the steps see it.
struct State {
  std::array<double, 3> x{};
};
State moved(State y, double a, const State& k) {
  for (std::size_t i = 0; i < 3; ++i) y.x[i] += a * k.x[i];
  return y;
}
State scaled(double a, const State& k) {
  return moved({}, a, k);
}

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

// y' = y turns a step into a polynomial in dt: the methods' stability functions. With dt = 2^-3 every term counts.
TEST(RungeKutta, StepsAreTheirPolynomials) {
  const auto f = [](double, const State& y) { return y; };
  const State one{{1, 0, 0}};
  constexpr double z = 0.125;
  const double to_fourth = 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)));
  const double z5 = std::pow(z, 5), z6 = std::pow(z, 6), z7 = std::pow(z, 7);
  constexpr double rounding = 1e-15;
  EXPECT_NEAR(rk4_step(f, 0, one, z).x[0], to_fourth, rounding);
  const auto step = dormand_prince_step(f, 0, one, one, z);
  EXPECT_NEAR(step.y.x[0], to_fourth + z5 / 120 + z6 / 600, rounding);
  const double lower = to_fourth + 1097 * z5 / 120000 + 161 * z6 / 120000 + z7 / 24000;
  EXPECT_NEAR(step.error.x[0], step.y.x[0] - lower, rounding);
  EXPECT_EQ(step.last.x[0], step.y.x[0]);
}

// ∫(n+1) tⁿ dt from 1 to 3: exact up to n = 3 by the classic method (Simpson's rule), up to n = 4 by the embedded pair,
// which estimates no error up to n = 3.
TEST(RungeKutta, QuadratureIsOfTheOrderOfTheMethod) {
  for (int n = 0; n <= 5; ++n) {
    const auto f = [n](double t, const State&) { return State{{(n + 1) * std::pow(t, n), 0, 0}}; };
    const double exact = std::pow(3, n + 1) - 1;
    const double rounding = 1e-14 * exact;
    const double classic = rk4_step(f, 1, State{}, 2).x[0];
    const auto pair = dormand_prince_step(f, 1, State{}, f(1, State{}), 2);
    if (n <= 3) {
      EXPECT_NEAR(classic, exact, rounding) << n;
      EXPECT_NEAR(pair.error.x[0], 0, rounding) << n;
    } else {
      EXPECT_GT(std::abs(classic - exact), 1e3 * rounding) << n;
      EXPECT_GT(std::abs(pair.error.x[0]), 1e3 * rounding) << n;
    }
    if (n <= 4) {
      EXPECT_NEAR(pair.y.x[0], exact, rounding) << n;
    } else {
      EXPECT_GT(std::abs(pair.y.x[0] - exact), 1e3 * rounding) << n;
    }
  }
}

// Errors of order 5: halving the step divides them by 32 as the step goes to 0; a quarter more or less at these steps.
TEST(RungeKutta, EmbeddedPairIsOfOrderFiveInTheOrificeFlow) {
  const auto error = [](int steps) {
    const double dt = OrificeFlow().residence(x0, z0, z1) / steps;
    EmbeddedStep<State> step{start, {}, orifice(0, start)};
    for (int s = 0; s < steps; ++s) step = dormand_prince_step(orifice, s * dt, step.y, step.last, dt);
    return std::abs(step.y.x[2] - z1);
  };
  EXPECT_NEAR(error(20) / error(40), 32, 8);
  EXPECT_NEAR(error(40) / error(80), 32, 8);
}

}  // namespace
}  // namespace grainvdb
