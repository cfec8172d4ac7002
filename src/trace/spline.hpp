#pragma once
/// Weights of values at whole numbers for a place between them.
#include <array>
#include <cstddef>

namespace grainvdb {

/// Weights of the values at 0 and 1 for the value, and for its derivative, at s in [0, 1].
inline std::array<double, 2> linear_weights(double s) {
  return {1 - s, s};
}
inline std::array<double, 2> linear_slopes(double) {
  return {-1, 1};
}

/// The same for the values at -1, 0, 1 and 2, by the Catmull-Rom spline: cubic in s, through the values at 0 and 1,
/// with the slopes of central differences there.
inline std::array<double, 4> cubic_weights(double s) {
  return {((-0.5 * s + 1) * s - 0.5) * s, (1.5 * s - 2.5) * s * s + 1, ((-1.5 * s + 2) * s + 0.5) * s,
          (0.5 * s - 0.5) * s * s};
}
inline std::array<double, 4> cubic_slopes(double s) {
  return {(-1.5 * s + 2) * s - 0.5, (4.5 * s - 5) * s, (-4.5 * s + 4) * s + 0.5, (1.5 * s - 1) * s};
}

}  // namespace grainvdb
