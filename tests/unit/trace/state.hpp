#pragma once
/// A position as the Runge-Kutta steps see it.
#include <array>
#include <cstddef>

namespace grainvdb::testing {

struct State {
  std::array<double, 3> x{};
};
inline State moved(State y, double a, const State& k) {
  for (std::size_t i = 0; i < 3; ++i) y.x[i] += a * k.x[i];
  return y;
}
inline State scaled(double a, const State& k) {
  return moved({}, a, k);
}

}  // namespace grainvdb::testing
