#pragma once
/// Numbers with a bound of their error, carried through formulas: running error analysis. A result that differs from
/// `value` by more than `error` is wrong.
#include <algorithm>
#include <cmath>
#include <limits>

namespace grainvdb::testing {

struct Uncertain {
  double value = 0;
  double error = 0;  ///< ≥ 0

  bool undefined() const { return std::isnan(value); }
};

inline Uncertain undefined_value() {
  return {std::numeric_limits<double>::quiet_NaN(), 0};
}

inline Uncertain operator+(const Uncertain& a, const Uncertain& b) {
  return {a.value + b.value, a.error + b.error};
}
inline Uncertain operator-(const Uncertain& a, const Uncertain& b) {
  return {a.value - b.value, a.error + b.error};
}
inline Uncertain operator*(const Uncertain& a, const Uncertain& b) {
  return {a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error};
}
inline Uncertain operator*(double a, const Uncertain& b) {
  return {a * b.value, std::abs(a) * b.error};
}
inline Uncertain operator/(const Uncertain& a, const Uncertain& b) {
  const double least = std::abs(b.value) - b.error;  // of |b|
  const double q = a.value / b.value;
  return {q, least > 0 ? (a.error + std::abs(q) * b.error) / least : std::numeric_limits<double>::infinity()};
}
inline Uncertain operator/(const Uncertain& a, double b) {
  return {a.value / b, a.error / std::abs(b)};
}

/// √(max(a, 0)). Its error is the larger of the two distances to the roots of the interval's ends.
inline Uncertain root(const Uncertain& a) {
  const double r = std::sqrt(std::max(a.value, 0.0));
  const double above = std::sqrt(std::max(a.value + a.error, 0.0)) - r;
  const double below = r - std::sqrt(std::max(a.value - a.error, 0.0));
  return {r, std::max(above, below)};
}

/// Half an ulp of float, relative: what storing a value in a float grid costs.
inline constexpr double float_rounding = 0x1p-24;

/// The value as it comes back from a float grid (which also loses what is below its smallest number).
inline Uncertain stored(const Uncertain& a) {
  return {a.value, a.error + float_rounding * (std::abs(a.value) + a.error) + 0x1p-149};
}

/// Whether a > threshold, and whether the error leaves that in no doubt.
struct Verdict {
  bool yes = false;
  bool sure = true;
};
inline Verdict exceeds(const Uncertain& a, double threshold) {
  return {a.value > threshold, std::abs(a.value - threshold) > a.error || a.error == 0};
}

}  // namespace grainvdb::testing
