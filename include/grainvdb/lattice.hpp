#pragma once
/// The voxel lattice: voxel (i,j,k) has its centre at origin + (i+½, j+½, k+½) h. The origin is the user's, so that
/// results of different runs lie on the same lattice.
#include <array>
#include <cstdint>
#include <optional>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// Integer voxel coordinates, ordered lexicographically.
struct Coord {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const Coord&) const = default;
  std::int32_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

/// The voxels of one period along an axis: first, first+1, …, first+count-1.
struct Period {
  std::int32_t first = 0;
  std::int32_t count = 0;
  double length = 0;  ///< of the box in voxels, count to a relative 1e-6: what unwrapped coordinates repeat by
};

class Lattice {
 public:
  /// `voxel` h > 0 is the edge of a voxel [length]. Throws std::invalid_argument otherwise.
  Lattice(double voxel, const Vec3& origin);

  /// Makes the lattice periodic along the periodic axes of `box`. A periodic length must be a whole number of voxels
  /// (relative error ≤ 1e-6); throws std::invalid_argument with the nearest fitting voxel sizes otherwise, and when
  /// a voxel of the period would not have a 31-bit index.
  void set_periods(const Box& box);

  /// The same voxels, with lengths in another unit of this size > 0 [length].
  Lattice in_unit(double size) const;

  double voxel() const { return voxel_; }
  const Vec3& origin() const { return origin_; }
  const std::optional<Period>& period(int axis) const { return period_[axis]; }

  /// Position in index space: whole numbers are voxel centres.
  double to_index(int axis, double x) const { return (x - origin_[axis]) / voxel_ - 0.5; }
  /// Position of the centre of voxel i along an axis [length].
  double centre(int axis, std::int32_t i) const { return origin_[axis] + (i + 0.5) * voxel_; }
  Vec3 centre(const Coord& c) const { return {centre(0, c.x), centre(1, c.y), centre(2, c.z)}; }

  /// The image of a position u in index space that lies in [first - ½, first - ½ + length) along an axis with a period;
  /// u itself along any other.
  double wrap_index(int axis, double u) const;

  /// The voxel of the stored period that i is an image of; i itself along an axis without period.
  std::int32_t wrap(int axis, std::int32_t i) const;
  Coord wrap(const Coord& c) const { return {wrap(0, c.x), wrap(1, c.y), wrap(2, c.z)}; }
  /// Whether voxel i belongs to the stored period (always true along an axis without one).
  bool contains(int axis, std::int32_t i) const;

 private:
  double voxel_;
  Vec3 origin_;
  std::array<std::optional<Period>, 3> period_;
};

}  // namespace grainvdb
