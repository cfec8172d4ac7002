#pragma once
/// Composite Gauss-Legendre quadrature in long double: the independent reference of the kernel tests.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace quadrature {

inline constexpr int points = 12;

/// Nodes and weights on [-1, 1], by Newton's method on the Legendre recurrence.
inline const std::array<std::pair<long double, long double>, points>& rule() {
  static const auto nodes = [] {
    std::array<std::pair<long double, long double>, points> result;
    for (int i = 0; i < points; ++i) {
      long double x = std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (points + 0.5L));
      long double slope = 0;
      for (int step = 0; step < 20; ++step) {
        long double previous = 1, p = x;
        for (int k = 2; k <= points; ++k) previous = std::exchange(p, ((2 * k - 1) * x * p - (k - 1) * previous) / k);
        slope = points * (x * p - previous) / (x * x - 1);
        x -= p / slope;
      }
      result[static_cast<std::size_t>(i)] = {x, 2 / ((1 - x * x) * slope * slope)};
    }
    return result;
  }();
  return nodes;
}

/// ∫ f from lo to hi on `parts` equal intervals.
template <class F>
long double integrate(F&& f, long double lo, long double hi, int parts) {
  const long double half = (hi - lo) / (2 * parts);
  long double sum = 0;
  for (int k = 0; k < parts; ++k)
    for (const auto& [x, w] : rule()) sum += w * f(lo + half * (2 * k + 1 + x));
  return sum * half;
}

/// ∫ f(t) from lo to hi where f is smooth but for branch points at Re t = 0, on either side of the origin or in it:
/// intervals that shrink towards 0 by halves, so that each is as far from the branch points as it is long.
template <class F>
long double integrate_about_zero(F&& f, long double lo, long double hi) {
  long double sum = 0;
  const auto add_side = [&](long double sign, long double near, long double far) {
    for (int k = 0; k < 60 && far > near; ++k) {
      const long double middle = k == 59 ? near : std::max(near, far / 2);
      sum += integrate([&](long double t) { return f(sign * t); }, middle, far, 3);
      far = middle;
    }
  };
  if (hi > 0) add_side(1, std::max(lo, 0.0L), hi);
  if (lo < 0) add_side(-1, std::max(-hi, 0.0L), -lo);
  return sum;
}

}  // namespace quadrature
