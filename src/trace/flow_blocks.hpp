#pragma once
/// A velocity laid out for sampling: a copy of each leaf with the voxels around it, the components of a voxel side by
/// side. A sample reads one block, whatever leaves its voxels lie in.
#include <array>
#include <cstddef>
#include <vector>

#include "grainvdb/flow.hpp"
#include "trace/leaf_index.hpp"

namespace grainvdb {

/// How many values a voxel has in a block: the velocity and the shear rate.
inline constexpr std::size_t flow_lanes = 4;

struct FlowBlocks {
  FlowBlocks(const Lattice& lattice, const SparseField& velocity, const SparseField* shear_rate,
             Interpolation interpolation);

  /// The block of the leaf with this number; one without values for the number of leaves, so that every number that
  /// LeafIndex::find gives has a block.
  const float* block(std::size_t leaf) const { return values.data() + leaf * block_size(); }
  std::size_t block_size() const { return offset({edge - 1, edge - 1, edge - 1}) + flow_lanes; }
  /// Where the block's first voxel used by a cell is: the cell's lower voxel, less `below` along each axis.
  std::size_t offset(const std::array<int, 3>& in_leaf) const {
    const auto at = [&](std::size_t a) { return static_cast<std::size_t>(in_leaf[a]); };
    const auto n = static_cast<std::size_t>(edge);
    return ((at(0) * n + at(1)) * n + at(2)) * flow_lanes;
  }

  Lattice lattice;
  Interpolation interpolation;
  int below;  ///< voxels in front of the leaf, 0 or 1
  int edge;   ///< voxels along a block: those of the leaf, those in front of it and those behind it
  LeafIndex index;
  std::vector<float> values;  ///< [leaf][x][y][z][lane]; NaN where a voxel is inactive
};

}  // namespace grainvdb
