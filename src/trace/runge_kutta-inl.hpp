// Runge-Kutta steps of dy/dt = f(t, y), compiled once for every instruction set: include it from files that
// hwy/foreach_target.h compiles again and again, after hwy/highway.h, or from one that it does not.
#if defined(GRAINVDB_TRACE_RUNGE_KUTTA_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_TRACE_RUNGE_KUTTA_INL_HPP
#undef GRAINVDB_TRACE_RUNGE_KUTTA_INL_HPP
#else
#define GRAINVDB_TRACE_RUNGE_KUTTA_INL_HPP
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {

// A State has `State moved(y, a, k)`, y + a k, and `State scaled(a, k)`, a k, found by its namespace. f(t, y) returns a
// State.

/// The classic method of order 4.
template <class State, class F>
HWY_INLINE State rk4_step(F& f, double t, const State& y, double dt) {
  const State k1 = f(t, y);
  const State k2 = f(t + dt / 2, moved(y, dt / 2, k1));
  const State k3 = f(t + dt / 2, moved(y, dt / 2, k2));
  const State k4 = f(t + dt, moved(y, dt, k3));
  return moved(moved(y, dt / 6, moved(k1, 2, k2)), dt / 6, moved(k4, 2, k3));
}

/// What an embedded pair gives: the new state, the estimated error of the step, and f there.
template <class State>
struct EmbeddedStep {
  State y, error, last;
};

/// The pair 5(4) of Dormand and Prince; k1 = f(t, y) is the `last` of the step before. The state is that of order 5.
template <class State, class F>
HWY_INLINE EmbeddedStep<State> dormand_prince_step(F& f, double t, const State& y, const State& k1, double dt) {
  const auto at = [&](double c, const State& z) { return f(t + c * dt, z); };
  const auto add = [&](const State& z, double a, const State& k) { return moved(z, a * dt, k); };
  const State k2 = at(1.0 / 5, add(y, 1.0 / 5, k1));
  const State k3 = at(3.0 / 10, add(add(y, 3.0 / 40, k1), 9.0 / 40, k2));
  const State k4 = at(4.0 / 5, add(add(add(y, 44.0 / 45, k1), -56.0 / 15, k2), 32.0 / 9, k3));
  const State k5 =
      at(8.0 / 9, add(add(add(add(y, 19372.0 / 6561, k1), -25360.0 / 2187, k2), 64448.0 / 6561, k3), -212.0 / 729, k4));
  const State k6 =
      at(1.0, add(add(add(add(add(y, 9017.0 / 3168, k1), -355.0 / 33, k2), 46732.0 / 5247, k3), 49.0 / 176, k4),
                  -5103.0 / 18656, k5));
  const State next =
      add(add(add(add(add(y, 35.0 / 384, k1), 500.0 / 1113, k3), 125.0 / 192, k4), -2187.0 / 6784, k5), 11.0 / 84, k6);
  const State k7 = at(1.0, next);
  // Weights of order 5 less those of order 4.
  const State e3 = moved(scaled(71.0 / 57600, k1), -71.0 / 16695, k3);
  const State e5 = moved(moved(e3, 71.0 / 1920, k4), -17253.0 / 339200, k5);
  return {next, scaled(dt, moved(moved(e5, 22.0 / 525, k6), -1.0 / 40, k7)), k7};
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
