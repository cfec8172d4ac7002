#pragma once
/// The voxels that a scene can reach, in one dense array: the index of the brute force.
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb::testing {

/// One period along periodic axes, beginning with the first voxel whose centre lies in the box; along open axes
/// everything within `reach` of a particle of any frame.
class VoxelBox {
 public:
  VoxelBox(const std::vector<Frame>& frames, double voxel, const Vec3& origin, double reach);

  double voxel() const { return voxel_; }
  const Box& box() const { return box_; }
  std::size_t size() const { return static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]; }
  Coord coord(std::size_t n) const;
  /// Of a voxel or, along periodic axes, of the stored voxel that it is an image of.
  std::optional<std::size_t> index(Coord c) const;
  Vec3 centre(const Coord& c) const;
  Vec3 centre(std::size_t n) const { return centre(coord(n)); }
  /// (x - origin)/h - ½: whole numbers at voxel centres.
  Vec3 to_index_space(const Vec3& x) const;

 private:
  double voxel_;
  Vec3 origin_;
  Box box_;
  std::array<int, 3> first_{};
  std::array<std::size_t, 3> count_{};
};

/// The voxel `by` steps along an axis from c.
Coord shifted(Coord c, int axis, int by);

}  // namespace grainvdb::testing
