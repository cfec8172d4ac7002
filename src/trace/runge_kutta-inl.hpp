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

/// The pair 3(2) of Bogacki and Shampine; k1 = f(t, y) is the `last` of the step before. The state is that of order 3.
template <class State, class F>
HWY_INLINE EmbeddedStep<State> bogacki_shampine_step(F& f, double t, const State& y, const State& k1, double dt) {
  const State k2 = f(t + dt / 2, moved(y, dt / 2, k1));
  const State k3 = f(t + 3 * dt / 4, moved(y, 3 * dt / 4, k2));
  const State next = moved(moved(moved(y, 2 * dt / 9, k1), dt / 3, k2), 4 * dt / 9, k3);
  const State k4 = f(t + dt, next);
  // Weights of order 3 less those of order 2.
  return {next, moved(moved(moved(scaled(-5 * dt / 72, k1), dt / 12, k2), dt / 9, k3), -dt / 8, k4), k4};
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
