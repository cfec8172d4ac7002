#pragma once
/// Sums over bricks of voxels as the kernels leave them, and how they come to their voxels.
#include <cstddef>

#include "grainvdb/topology.hpp"
#include "splat/grow.hpp"

namespace grainvdb {

/// Several sums at each voxel of a leaf, [brick][row][lane]. A brick is 2×2×(lanes/4) voxels, or a single one without
/// vectors; bricks ascend with x, then y, then z, and so do the lanes of each.
struct BrickSums {
  Grow<float> values;
  int lanes = 1;
  int rows = 0;

  float* room(int lanes_of_brick, int rows_of_brick) {
    lanes = lanes_of_brick;
    rows = rows_of_brick;
    return values.room(static_cast<std::size_t>(rows) * leaf_size);
  }
  /// Where row 0 of a voxel is; other rows follow at a distance of `lanes`.
  std::size_t place(int offset) const {
    const int across = lanes == 1 ? 1 : 2, along = lanes / (across * across);
    const int x = offset >> 6, y = (offset >> 3) & 7, z = offset & 7;
    const int brick = ((x / across) * (leaf_edge / across) + y / across) * (leaf_edge / along) + z / along;
    const int lane = ((x % across) * across + y % across) * along + z % along;
    return static_cast<std::size_t>(brick * rows * lanes + lane);
  }
  float at(int row, int offset) const { return values[place(offset) + static_cast<std::size_t>(row * lanes)]; }
};

/// unit · sum + reference · weight at a leaf's voxels: two rows of its sums.
struct ScaledSum {
  int sum = 0;
  double unit = 1;
  int weight = 0;
  double reference = 0;
};

/// Writes it to the active voxels, and 0 to the others.
void scale_sums(const BrickSums& from, const ScaledSum& what, const LeafMask& active, double* to);
void scale_sums(const BrickSums& from, const ScaledSum& what, const LeafMask& active, float* to);

}  // namespace grainvdb
