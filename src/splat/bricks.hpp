#pragma once
/// The fast particle splat of one leaf: single-precision sums over bricks of voxels that fill a vector register,
/// compiled for every instruction set the library supports and chosen at run time.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "grainvdb/topology.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"
#include "splat/processor.hpp"

namespace grainvdb {

/// What a leaf's sums are made of.
struct LeafSplat {
  const LeafCandidates* candidates = nullptr;
  const float* values = nullptr;  ///< of the candidates, [candidate][stride]
  std::size_t stride = 0;         ///< of the values, at least `channels`
  int channels = 0;
  float voxel = 0;  ///< edge of a voxel in units of the cutoff
  /// Whether to take registers of 512 bits by halves. The sums are the same: what does not reach a voxel adds nothing.
  bool halves = halves_wide_registers();
  /// Where the 512 values of each channel will go afterwards: asked for while the sums are made. May be empty.
  std::span<float* const> to = {};
};

/// What the sums are of: this part of W/W(0).
constexpr double summed_part = 1.0 / 3;

/// Sums of one leaf, and what is needed on the way; reused from leaf to leaf.
struct LeafSums {
  Grow<float> sums;   ///< [channel][offset]: Σ q (1-r)³(1+3r)/3 over the candidates
  Grow<float> plain;  ///< [offset]: Σ (1-r)³(1+3r)/3

  static constexpr std::size_t most_bricks = 64;       ///< of a block
  Picked near;                                         ///< candidates of a block of voxels
  std::array<Grow<std::int32_t>, most_bricks> chosen;  ///< those of them that reach each brick
  Grow<float> weights;                                 ///< [candidate of the brick][lane]
};

/// Fills sums and plain for the bricks that hold an active voxel; those of other bricks are not touched.
void splat_leaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out);

/// unit · sum[offset] + reference · weight[offset] of a leaf's voxels.
struct ScaledSum {
  const float* sum;
  double unit;
  const float* weight;
  double reference;
};
/// Writes it to the active voxels and 0 to the others.
void scale_sums(const ScaledSum& from, const LeafMask& active, double* to);
void scale_sums(const ScaledSum& from, const LeafMask& active, float* to);

/// The active voxels where plain < rim, or |sum| < least and plain < enough.
LeafMask faint_voxels(const float* sum, float least, const float* plain, float rim, float enough,
                      const LeafMask& active);

/// The least of a leaf's values at its active voxels.
float least_of(const float* values, const LeafMask& active);

/// few[channel] = how many of `count` values, [candidate][stride], are smaller than limit[channel] in magnitude. Limits
/// and counts have `stride` elements.
void count_below(const float* values, std::size_t stride, std::size_t count, const float* limit, float* few);

/// The instruction set that splat_leaf uses on this machine.
const char* splat_target();

}  // namespace grainvdb
