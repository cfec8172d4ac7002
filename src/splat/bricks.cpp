#include "splat/bricks.hpp"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/bricks.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/blocks-inl.hpp"
#include "splat/doubt-inl.hpp"
#include "splat/particle_bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

bool any_active(const LeafMask& active, const VoxelBox& box) {
  std::uint64_t row = 0;
  for (int j = 0; j < block; ++j) row |= ((std::uint64_t{1} << block) - 1) << ((box.y + j) * 8 + box.z);
  std::uint64_t any = 0;
  for (int i = 0; i < block; ++i) any |= active.words[static_cast<std::size_t>(box.x + i)] & row;
  return any != 0;
}

/// The candidates of every brick of a block, in the order of for_each_brick: places in the leaf's list, as many more as
/// weigh_and_sum looks ahead.
template <class Tag>
HWY_NOINLINE void pick_bricks(const Picked& near, const VoxelBox& box, float h,
                              std::array<Grow<std::int32_t>, LeafSums::most_bricks>& lists, std::size_t* counts) {
  using B = Brick<Tag>;
  const Beyond<B::x, block / B::x> along_x(box.x, h);
  const Beyond<B::y, block / B::y> along_y(box.y, h);
  const Beyond<B::z, block / B::z> along_z(box.z, h);
  constexpr int bricks = along_x.count * along_y.count * along_z.count;
  std::int32_t* to[bricks];
  for (std::size_t b = 0; b < bricks; ++b) to[b] = lists[b].room(near.count + look_ahead);
  const V limit = hn::Set(d, 1 + margin);
  for (std::size_t i = 0; i < near.count; i += lanes) {
    V x[block], y[block], z[block];
    along_x(hn::Load(d, near.x.data() + i), x);
    along_y(hn::Load(d, near.y.data() + i), y);
    along_z(hn::Load(d, near.z.data() + i), z);
    const auto place = hn::Load(di, near.at.data() + i);
    const auto valid = hn::FirstN(d, near.count - i);
    int b = 0;
    for (int ix = 0; ix < along_x.count; ++ix)
      for (int iy = 0; iy < along_y.count; ++iy) {
        const V xy = hn::Add(x[ix], y[iy]);
        for (int iz = 0; iz < along_z.count; ++iz, ++b) {
          const auto near_it = hn::And(hn::Lt(hn::Add(xy, z[iz]), limit), valid);
          to[b] += store_some(place, hn::RebindMask(di, near_it), di, to[b]);
        }
      }
  }
  for (std::size_t b = 0; b < bricks; ++b) {
    counts[b] = static_cast<std::size_t>(to[b] - lists[b].data());
    for (std::size_t k = 0; k < look_ahead; ++k) to[b][k] = 0;
  }
}

/// The sums of a brick, [row][lane].
template <class Tag>
void SumBrick(const LeafSplat& leaf, const Sources& from, const std::int32_t* chosen, std::size_t count,
              const VoxelBox& brick, Grow<float>& scratch, float* HWY_RESTRICT sums) {
  constexpr Tag tag;
  const auto at = brick_voxels_of(tag, brick, leaf.voxel);
  if (leaf.channels <= most_at_once) {
    weigh_and_sum_of<Tag>[static_cast<std::size_t>(leaf.channels)](from, chosen, count, at, sums);
  } else if constexpr (Brick<Tag>::lanes == lanes) {
    float* const weights = scratch.room(count * lanes);
    hn::Store(weigh(from, chosen, count, at, weights), d, sums);
    for (int first = 0; first < leaf.channels; first += widest) {
      const int now = leaf.channels - first < widest ? leaf.channels - first : widest;
      sum_of(static_cast<std::size_t>(now), leaf.stride)(weights, from.values + first, leaf.stride, chosen, count,
                                                         sums + (1 + first) * lanes);
    }
  }
}

/// Asks for the memory of one eighth of every channel's values.
HWY_INLINE void ask_for(std::span<float* const> to, int eighth) {
  constexpr int part = leaf_size / 8, line = 64 / sizeof(float);
  for (const float* values : to)
    for (int v = 0; v < part; v += line) __builtin_prefetch(values + eighth * part + v, 1, 2);
}

template <class Tag>
void SplatBlocks(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  using B = Brick<Tag>;
  const int rows = 1 + leaf.channels;
  float* const sums = out.sums.room(B::lanes, rows);
  const LeafCandidates& all = *leaf.candidates;
  const Sources from{all.x.data(), all.y.data(), all.z.data(), leaf.values, leaf.stride};
  pick_blocks(all, leaf.voxel, out.near);
  for (int b = 0; b < leaf_blocks; ++b) {
    const VoxelBox box = block_box(b);
    ask_for(leaf.to, b);
    if (!any_active(active, box)) continue;
    std::size_t counts[LeafSums::most_bricks];
    pick_bricks<Tag>(out.near[static_cast<std::size_t>(b)], box, leaf.voxel, out.chosen, counts);
    std::size_t list = 0;
    for_each_brick<Tag>(box, [&](const VoxelBox& brick) {
      const std::size_t count = counts[list];
      const std::int32_t* const chosen = out.chosen[list++].data();
      const std::uint32_t lanes_active = brick_bits<Tag>(active, brick);
      if (lanes_active == 0) return;
      float* const of_brick = sums + brick_number<Tag>(brick) * static_cast<std::size_t>(rows * B::lanes);
      SumBrick<Tag>(leaf, from, chosen, count, brick, out.weights, of_brick);
      if (leaf.doubtful != nullptr) report_doubt<Tag>(leaf, chosen, count, brick, of_brick, lanes_active, out);
    });
  }
}

void SplatLeaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  if constexpr (lanes == 16)
    if (leaf.channels <= most_at_once && leaf.halves) return SplatBlocks<hn::Half<D>>(leaf, active, out);
  SplatBlocks<D>(leaf, active, out);
}

const char* TargetName() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(SplatLeaf);
HWY_EXPORT(TargetName);
void splat_leaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  HWY_DYNAMIC_DISPATCH(SplatLeaf)(leaf, active, out);
}
const char* splat_target() {
  return HWY_DYNAMIC_DISPATCH(TargetName)();
}
}  // namespace grainvdb
#endif
