#pragma once
/// Standard errors of what is measured on grains that move together: by leaving out one slab of the material at a time.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "grainvdb/box.hpp"
#include "measure/jackknife_error.hpp"

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

}  // namespace grainvdb
