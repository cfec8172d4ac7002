// Which sums of a brick single precision may have spoilt, compiled once for every instruction set (see
// bricks-inl.hpp).
#if defined(GRAINVDB_SPLAT_DOUBT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_DOUBT_INL_HPP
#undef GRAINVDB_SPLAT_DOUBT_INL_HPP
#else
#define GRAINVDB_SPLAT_DOUBT_INL_HPP
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "splat/bricks-inl.hpp"
#include "splat/bricks.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {

// Rounding of positions and squared distances moves the rim of a support by some δ, mostly 6e-8 c and 3e-7 c at most,
// which changes W by a factor 3 δ/(1-r): more than 5e-6 for the terms with 1-r < 0.036, or 0.18 at most. They matter
// only where a sum has little else, and there the voxel is summed again in double:

/// where the sum of W/W(0) is less than this (the outermost voxels of the material),
constexpr double rim = 0.01;
/// and where the sum of a channel is less than this part of W(0) times the largest |q| around (its larger values are
/// far away), unless the candidates with small values are too few to be most of what the voxel sees.
constexpr double faint = 1e-3;
/// A value is small below this part of the largest. Where Σ W/W(0) exceeds their number n, Σ |q| W is at least
/// small (Σ W - n W(0)) max |q|.
constexpr double small = 1e-2;

/// The largest |value| of each channel among some candidates, and how many are smaller than `small` times that.
template <class Tag>
HWY_INLINE void largest_of(Tag tag, const float* HWY_RESTRICT values, std::size_t stride,
                           const std::int32_t* HWY_RESTRICT chosen, std::size_t count, float* HWY_RESTRICT largest,
                           float* HWY_RESTRICT few) {
  auto most = hn::Zero(tag), n = hn::Zero(tag);
  for (std::size_t k = 0; k < count; ++k)
    most = hn::Max(most, hn::Abs(hn::LoadU(tag, values + static_cast<std::size_t>(chosen[k]) * stride)));
  hn::StoreU(most, tag, largest);
  const auto limit = hn::Mul(hn::Set(tag, static_cast<float>(small)), most), one = hn::Set(tag, 1.0F);
  for (std::size_t k = 0; k < count; ++k) {
    const auto v = hn::Abs(hn::LoadU(tag, values + static_cast<std::size_t>(chosen[k]) * stride));
    n = hn::Add(n, hn::IfThenElseZero(hn::Lt(v, limit), one));
  }
  hn::StoreU(n, tag, few);
}

/// The lanes in doubt of each channel, by the largest values among the brick's own candidates. Each channel is judged
/// by itself, so that a sum does not depend on which others are asked for. Sums about a reference are small against the
/// reference, whose own sum is right: they are in doubt at the rim alone.
template <class Tag>
HWY_NOINLINE void find_doubt(const LeafSplat& leaf, const std::int32_t* HWY_RESTRICT chosen, std::size_t count,
                             const float* HWY_RESTRICT sums, std::uint32_t active, LeafSums& out,
                             DoubtfulBrick& brick) {
  constexpr Tag tag;
  const hn::CappedTag<float, 4> part;  // records are padded to four
  constexpr int width = Brick<Tag>::lanes;
  const auto channels = static_cast<std::size_t>(leaf.channels);
  float* const largest = out.largest.room(leaf.stride);
  float* const few = out.few.room(leaf.stride);
  std::size_t first = 0;
  for (; first + lanes <= leaf.stride; first += lanes)
    largest_of(d, leaf.values + first, leaf.stride, chosen, count, largest + first, few + first);
  for (; first < leaf.stride; first += hn::Lanes(part))
    largest_of(part, leaf.values + first, leaf.stride, chosen, count, largest + first, few + first);
  const auto plain = hn::Load(tag, sums);
  const auto at_rim = hn::Lt(plain, hn::Set(tag, static_cast<float>(summed_part * rim)));
  std::uint32_t* const lanes_of = out.doubt.room(channels);
  for (std::size_t c = 0; c < channels; ++c) {
    const float least = leaf.largest[c] > 0 ? static_cast<float>(summed_part * faint) * largest[c] : 0;
    const auto enough = static_cast<float>(summed_part * (static_cast<double>(few[c]) + faint / small));
    const auto is_small = hn::Lt(hn::Abs(hn::Load(tag, sums + (1 + c) * width)), hn::Set(tag, least));
    const auto doubt = hn::Or(at_rim, hn::And(is_small, hn::Lt(plain, hn::Set(tag, enough))));
    lanes_of[c] = bits_of(tag, doubt) & active;
    brick.any |= lanes_of[c];
  }
  brick.lanes = lanes_of;
}

/// Whether any sum may be in doubt, by the largest values of the leaf.
template <class Tag>
HWY_INLINE bool seems_doubtful(const LeafSplat& leaf, const float* HWY_RESTRICT sums, std::uint32_t active) {
  constexpr Tag tag;
  constexpr int width = Brick<Tag>::lanes;
  const auto part = hn::Set(tag, static_cast<float>(summed_part * faint));
  auto any = hn::Lt(hn::Load(tag, sums), hn::Set(tag, static_cast<float>(summed_part * rim)));
  for (int c = 0; c < leaf.channels; ++c)
    any = hn::Or(any,
                 hn::Lt(hn::Abs(hn::Load(tag, sums + (1 + c) * width)), hn::Mul(part, hn::Set(tag, leaf.largest[c]))));
  return (bits_of(tag, any) & active) != 0;
}

template <class Tag>
HWY_INLINE void report_doubt(const LeafSplat& leaf, const std::int32_t* HWY_RESTRICT chosen, std::size_t count,
                             const VoxelBox& box, const float* HWY_RESTRICT sums, std::uint32_t active, LeafSums& out) {
  if (!seems_doubtful<Tag>(leaf, sums, active)) return;
  DoubtfulBrick brick{nullptr, chosen, count, nullptr, 0};
  find_doubt<Tag>(leaf, chosen, count, sums, active, out, brick);
  if (brick.any == 0) return;
  std::int32_t voxels[Brick<Tag>::lanes];
  for (int lane = 0; lane < Brick<Tag>::lanes; ++lane) voxels[lane] = lane_offset<Tag>(box, lane);
  brick.voxels = voxels;
  leaf.doubtful->take(brick);
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
