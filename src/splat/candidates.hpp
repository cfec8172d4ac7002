#pragma once
/// The entries whose support can touch a leaf, as the vector kernels read them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/topology.hpp"
#include "splat/grow.hpp"

namespace grainvdb {

/// Some entries of one cell that lie within reach of a leaf.
struct CellRange {
  std::size_t cell = 0;
  std::size_t begin = 0, end = 0;  ///< of its candidates
};

/// Candidates of one leaf in ascending order of their entries. Positions are relative to the leaf's centre, in units of
/// the cutoff, and exact to 2e-7.
struct LeafCandidates {
  Grow<float> x, y, z;
  Grow<std::uint32_t> entry;
  std::size_t count = 0;
  std::vector<CellRange> cells;  ///< those with candidates, ascending
};

/// Collects the entries within `cutoff` (in voxels) of the box of the leaf's voxel centres.
void gather_candidates(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out);

/// Collects those of the leaf's own cell alone.
void gather_own(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out);

/// A box of voxel centres of a leaf: the first voxel, and how many there are along each edge.
struct VoxelBox {
  int x = 0, y = 0, z = 0;
  int edge = 1;
};

/// Positions of candidates that were picked, with their places in the list they were picked from.
struct Picked {
  Grow<float> x, y, z;
  Grow<std::int32_t> at;
  std::size_t count = 0;
};

/// Blocks of 4³ voxels in a leaf, numbered 4 (x/4) + 2 (y/4) + z/4.
inline constexpr int leaf_blocks = 8;
/// Candidates near each of them.
using NearBlocks = std::array<Picked, leaf_blocks>;

/// Picks those that may lie within the cutoff of a voxel of the box, in their order.
void pick_near(const LeafCandidates& candidates, const VoxelBox& box, float voxel, Picked& out);

/// Adds to `inside` voxels that certainly lie within the cutoff of a candidate: most that do, at little cost. `voxel`
/// is in units of the cutoff.
void cover_some(const LeafCandidates& candidates, float voxel, LeafMask& inside);

/// The same for all that do, and to `perhaps` those that may be among them, by the precision of the positions.
void cover(const LeafCandidates& candidates, float voxel, NearBlocks& scratch, LeafMask& inside, LeafMask& perhaps);

}  // namespace grainvdb
