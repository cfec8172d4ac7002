#pragma once
/// Standard errors of what is measured on grains that move together: by leaving out one slab of the material at a time.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// Slabs of equal thickness across the longest side of a box. Frames share them: grains that move little between frames
/// are then no new evidence.
class Slabs {
 public:
  static constexpr std::size_t count = 10;

  explicit Slabs(const Box& box) {
    for (std::size_t a = 1; a < 3; ++a)
      if (box.length(static_cast<int>(a)) > box.length(static_cast<int>(axis_))) axis_ = a;
    lo_ = box.lo[axis_];
    thickness_ = box.length(static_cast<int>(axis_)) / static_cast<double>(count);
  }

  std::size_t of(const Vec3& x) const {
    if (!(thickness_ > 0)) return 0;
    const double slab = std::floor((x[axis_] - lo_) / thickness_);
    return static_cast<std::size_t>(std::clamp(slab, 0.0, static_cast<double>(count - 1)));
  }

 private:
  std::size_t axis_ = 0;
  double lo_ = 0, thickness_ = 0;
};

/// The delete-a-group jackknife: error² = (G-1)/G Σ_j (θ_j - θ̄)², θ_j the result without group j of G. It holds where
/// groups are independent: slabs thicker than what moves together. NaN for fewer than two groups or where a result is.
inline double jackknife_error(const std::vector<double>& without) {
  if (without.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto groups = static_cast<double>(without.size());
  double mean = 0, sum = 0;
  for (const double x : without) mean += x / groups;
  for (const double x : without) sum += (x - mean) * (x - mean);
  return std::sqrt((groups - 1) / groups * sum);
}

}  // namespace grainvdb
