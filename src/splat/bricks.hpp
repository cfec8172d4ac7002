#pragma once
/// The fast particle splat of one leaf: single-precision sums over bricks of voxels that fill a vector register,
/// compiled for every instruction set the library supports and chosen at run time.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "grainvdb/topology.hpp"
#include "splat/brick_sums.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"
#include "splat/processor.hpp"

namespace grainvdb {

/// A brick with sums that single precision may have spoilt. It lasts as long as the call that brings it.
struct DoubtfulBrick {
  const std::int32_t* voxels = nullptr;  ///< offset of each lane's voxel in the leaf
  const std::int32_t* chosen = nullptr;  ///< the candidates that reach the brick: places in the leaf's list
  std::size_t count = 0;                 ///< of these
  const std::uint32_t* lanes = nullptr;  ///< for each channel the lanes in doubt, as bits
  std::uint32_t any = 0;                 ///< in any channel
};

/// Who sums them again.
class DoubtfulSums {
 public:
  virtual ~DoubtfulSums() = default;
  virtual void take(const DoubtfulBrick& brick) = 0;
};

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
  /// Gets the bricks with doubtful sums, one by one, unless it is null.
  DoubtfulSums* doubtful = nullptr;
  /// The largest |value| of each channel that is judged by its own sums, else 0. Needed for doubtful sums.
  const float* largest = nullptr;
};

/// What the sums are of: this part of W/W(0).
constexpr double summed_part = 1.0 / 3;

/// Sums of one leaf, and what is needed on the way; reused from leaf to leaf.
struct LeafSums {
  /// The first row is Σ (1-r)³(1+3r)/3 over the candidates, the others are Σ q (1-r)³(1+3r)/3 for each channel.
  BrickSums sums;

  static constexpr std::size_t most_bricks = 64;       ///< of a block
  NearBlocks near;                                     ///< candidates of each block
  std::array<Grow<std::int32_t>, most_bricks> chosen;  ///< those of them that reach each brick
  Grow<float> weights;                                 ///< [candidate of the brick][lane]
  Grow<float> largest, few;                            ///< of each channel, for a brick that seems doubtful
  Grow<std::uint32_t> doubt;                           ///< of each channel
};

/// Fills the sums of the bricks that hold an active voxel; those of other bricks are not set.
void splat_leaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out);

/// The instruction set that splat_leaf uses on this machine.
const char* splat_target();

}  // namespace grainvdb
