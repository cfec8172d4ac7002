#pragma once
/// The fast sums over the branches of contacts near one leaf: bricks of voxels that fill a vector register, compiled
/// for every instruction set the library supports and chosen at run time. Lengths are in units of the cutoff and
/// positions relative to the leaf's centre, in single precision.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/line_rule.hpp"
#include "grainvdb/topology.hpp"
#include "splat/brick_sums.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"

namespace grainvdb {

/// A symmetric rule on a branch: nodes at the middle ± offset × arm, weights that add up to 1.
struct BranchRule {
  explicit BranchRule(std::span<const LineNode> nodes);
  int pairs = 0;
  bool has_middle = false;
  bool has_curvature = false;  ///< the middle alone, with the second derivative there
  float offset[4] = {};
  float weight[4] = {};
  float middle_weight = 0;
};

/// Candidates [first, last) share a rule; none of their arms is longer than 2 half_arm.
struct BranchClass {
  std::size_t first = 0, last = 0;
  const BranchRule* rule = nullptr;
  float half_arm = 0;
};

/// The branches that can touch a leaf. The record of an entry holds its arm (3) and its values.
struct LeafBranches {
  Grow<float> x, y, z;               ///< middles
  Grow<float> ax, ay, az, arm2;      ///< arms, and their squared lengths
  std::vector<std::uint32_t> entry;  ///< of each candidate
  const float* records = nullptr;    ///< [entry][stride]
  std::size_t stride = 0;
  float voxel = 0;

  std::size_t size() const { return entry.size(); }
};

/// Fills in the branches of some cells whose middle is within `reach` (in cutoffs) of the box of the leaf's voxel
/// centres, in their order. `to_cutoff` turns voxels into cutoffs.
void collect_branches(const Buckets& buckets, std::span<const std::size_t> cells, const Coord& leaf, double to_cutoff,
                      double reach, LeafBranches& to);

/// Scratch memory of the functions below.
struct BranchScratch {
  std::vector<std::int32_t> chosen;
  Grow<float> weights, sums;
};

/// A voxel that may or may not lie within one cutoff of a branch, by single precision.
struct DoubtfulVoxel {
  std::uint32_t entry;
  std::int32_t offset;
};

/// Adds to `mask` the voxels of `window` that certainly lie within one cutoff of a branch, and to `doubtful` those near
/// the surface of some branch's reach. Bricks of `mask` that are complete already cost nothing.
void reach_of_branches(const LeafBranches& leaf, const LeafMask& window, BranchScratch& scratch, LeafMask& mask,
                       std::vector<DoubtfulVoxel>& doubtful);

/// The candidates that may lie within 1 of a voxel, by the precision of the positions, in their order.
void branches_at_voxel(const LeafBranches& leaf, int offset, std::vector<std::int32_t>& out);

/// A row of sums for each channel: Σ q Σ_nodes weight (1-r)³(1+3r), in the bricks with a voxel of `mask`; those of
/// other bricks are not set.
void sum_branches(const LeafBranches& leaf, std::span<const BranchClass> classes, int channels, const LeafMask& mask,
                  BranchScratch& scratch, BrickSums& sums);

/// Sums whose magnitude is below faint[block][channel] may have lost their accuracy to rounding at the rims of the
/// supports; 0 where there are none.
void faint_limits(const LeafBranches& leaf, int channels, BranchScratch& scratch, float* faint);

}  // namespace grainvdb
