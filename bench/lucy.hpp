#pragma once
/// The kernel as the baselines and the reference compute it, apart from the library's: W(r) = 105/(16 π c³)
/// (1-q)³ (1+3q), q = r/c < 1.
#include <cmath>
#include <numbers>

namespace grainvdb::bench {

inline double lucy_peak(double c) {
  return 105 / (16 * std::numbers::pi * c * c * c);
}

/// W/W(0) at q = r/c < 1.
inline double lucy_shape(double q) {
  const double p = 1 - q;
  return p * p * p * (1 + 3 * q);
}

/// Calls f(i, j, k, W) for every voxel (i, j, k) of size h with W > 0 about a point, whose position (x, y, z) is in
/// index space: whole numbers are voxel centres. Row by row, as one writes it first.
template <class F>
void for_each_weight(double x, double y, double z, double c, double h, F&& f) {
  const double reach = c / h;
  const double peak = lucy_peak(c);
  const auto first = [reach](double u) { return static_cast<int>(std::ceil(u - reach)); };
  const auto last = [reach](double u) { return static_cast<int>(std::floor(u + reach)); };
  for (int i = first(x); i <= last(x); ++i)
    for (int j = first(y); j <= last(y); ++j)
      for (int k = first(z); k <= last(z); ++k) {
        const double r2 = (i - x) * (i - x) + (j - y) * (j - y) + (k - z) * (k - z);
        if (r2 >= reach * reach) continue;
        const double w = peak * lucy_shape(std::sqrt(r2) / reach);
        if (w > 0) f(i, j, k, w);
      }
}

}  // namespace grainvdb::bench
