#pragma once
/// The simulation box of one snapshot: bounds, periodicity, wrapping and the minimum image.
#include <array>

namespace grainvdb {

using Vec3 = std::array<double, 3>;

/// An orthogonal box. Tilted (triclinic) boxes are refused where dumps are read.
/// Lengths are in the dump's own unit system.
struct Box {
  Vec3 lo{};
  Vec3 hi{};
  std::array<bool, 3> periodic{};

  double length(int axis) const { return hi[axis] - lo[axis]; }

  /// The image of coordinate x in [lo, hi) along a periodic axis; x itself along any other.
  double wrap(int axis, double x) const;

  /// The shortest image of the difference dx along a periodic axis (|result| ≤ length/2); dx itself along any other.
  double minimum_image(int axis, double dx) const;

  bool operator==(const Box&) const = default;
};

}  // namespace grainvdb
