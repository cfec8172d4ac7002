#include "splat/bricks.hpp"

#include <array>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/bricks.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/particle_bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

/// Copies the lanes of a brick to their voxels.
template <class Tag>
HWY_INLINE void put(const float* HWY_RESTRICT lane, const VoxelBox& brick, float* HWY_RESTRICT voxels) {
  using B = Brick<Tag>;
  for (int i = 0; i < B::x; ++i)
    for (int j = 0; j < B::y; ++j)
      std::memcpy(voxels + (brick.x + i) * 64 + (brick.y + j) * 8 + brick.z, lane + (i * B::y + j) * B::z,
                  B::z * sizeof(float));
}

bool any_active(const LeafMask& active, const VoxelBox& box, int nx, int ny, int nz) {
  std::uint64_t row = 0;
  for (int j = 0; j < ny; ++j) row |= ((std::uint64_t{1} << nz) - 1) << ((box.y + j) * 8 + box.z);
  std::uint64_t any = 0;
  for (int i = 0; i < nx; ++i) any |= active.words[static_cast<std::size_t>(box.x + i)] & row;
  return any != 0;
}

/// The bricks of a block, in the order of the lists of their candidates.
template <class Tag, class F>
HWY_INLINE void for_each_brick(const VoxelBox& box, const F& f) {
  using B = Brick<Tag>;
  std::size_t n = 0;
  for (int x = 0; x < block; x += B::x)
    for (int y = 0; y < block; y += B::y)
      for (int z = 0; z < block; z += B::z) f(n++, VoxelBox{box.x + x, box.y + y, box.z + z});
}

/// Squared distances along one axis from the bricks of a block, which are `size` voxels long.
template <int size>
struct Beyond {
  static constexpr int count = block / size;
  Beyond(int first, float h) {
    const float half = 0.5F * h * static_cast<float>(size - 1);
    reach = hn::Set(d, half);
    for (int b = 0; b < count; ++b) middle[b] = hn::Set(d, h * (static_cast<float>(first + b * size) - 3.5F) + half);
  }
  HWY_INLINE void operator()(V x, V* squared) const {
    for (int b = 0; b < count; ++b) {
      const V beyond = hn::Max(hn::Sub(hn::Abs(hn::Sub(x, middle[b])), reach), hn::Zero(d));
      squared[b] = hn::Mul(beyond, beyond);
    }
  }
  V reach;
  V middle[count];
};

/// The candidates of every brick of a block: places in the leaf's list, as many more as weigh_and_sum looks ahead.
template <class Tag>
HWY_NOINLINE void pick_bricks(const Picked& near, const VoxelBox& box, float h,
                              std::array<Grow<std::int32_t>, LeafSums::most_bricks>& lists, std::size_t* counts) {
  using B = Brick<Tag>;
  const Beyond<B::x> along_x(box.x, h);
  const Beyond<B::y> along_y(box.y, h);
  const Beyond<B::z> along_z(box.z, h);
  constexpr int bricks = along_x.count * along_y.count * along_z.count;
  std::int32_t* to[bricks];
  for (std::size_t b = 0; b < bricks; ++b) to[b] = lists[b].room(near.count + look_ahead);
  const V one = hn::Set(d, 1.0F);
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
          const auto near_it = hn::And(hn::Lt(hn::Add(xy, z[iz]), one), valid);
          to[b] += store_some(place, hn::RebindMask(di, near_it), di, to[b]);
        }
      }
  }
  for (std::size_t b = 0; b < bricks; ++b) {
    counts[b] = static_cast<std::size_t>(to[b] - lists[b].data());
    for (std::size_t k = 0; k < look_ahead; ++k) to[b][k] = 0;
  }
}

template <class Tag>
void SumBrick(const LeafSplat& leaf, const Sources& from, const std::int32_t* chosen, std::size_t count,
              const VoxelBox& brick, LeafSums& out) {
  constexpr Tag tag;
  constexpr int width = Brick<Tag>::lanes;
  HWY_ALIGN float sums[(1 + widest) * width];
  const auto deliver = [&](const float* from_lanes, int first, int channels) {
    for (int c = 0; c < channels; ++c)
      put<Tag>(from_lanes + c * width, brick, out.sums.data() + (first + c) * leaf_size);
  };
  const auto at = brick_voxels_of(tag, brick, leaf.voxel);
  if (leaf.channels <= most_at_once) {
    weigh_and_sum_of<Tag>[static_cast<std::size_t>(leaf.channels)](from, chosen, count, at, sums);
    put<Tag>(sums, brick, out.plain.data());
    deliver(sums + width, 0, leaf.channels);
  } else if constexpr (width == lanes) {
    float* const weights = out.weights.room(count * lanes);
    hn::Store(weigh(from, chosen, count, at, weights), d, sums);
    put<Tag>(sums, brick, out.plain.data());
    for (int first = 0; first < leaf.channels; first += widest) {
      const int now = leaf.channels - first < widest ? leaf.channels - first : widest;
      sum_of(static_cast<std::size_t>(now), leaf.stride)(weights, from.values + first, leaf.stride, chosen, count,
                                                         sums);
      deliver(sums, first, now);
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
  out.sums.room(static_cast<std::size_t>(leaf.channels) * leaf_size);
  out.plain.room(leaf_size);
  const LeafCandidates& all = *leaf.candidates;
  const Sources from{all.x.data(), all.y.data(), all.z.data(), leaf.values, leaf.stride};
  int eighth = 0;
  for (int bx = 0; bx < 8; bx += block)
    for (int by = 0; by < 8; by += block)
      for (int bz = 0; bz < 8; bz += block) {
        const VoxelBox box{bx, by, bz, block};
        ask_for(leaf.to, eighth++);
        if (!any_active(active, box, block, block, block)) continue;
        pick_near(all, box, leaf.voxel, out.near);
        std::size_t counts[LeafSums::most_bricks];
        pick_bricks<Tag>(out.near, box, leaf.voxel, out.chosen, counts);
        for_each_brick<Tag>(box, [&](std::size_t b, const VoxelBox& brick) {
          if (any_active(active, brick, B::x, B::y, B::z))
            SumBrick<Tag>(leaf, from, out.chosen[b].data(), counts[b], brick, out);
        });
      }
}

void SplatLeaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  if constexpr (lanes == 16)
    if (leaf.channels <= most_at_once && leaf.halves) return SplatBlocks<hn::Half<D>>(leaf, active, out);
  SplatBlocks<D>(leaf, active, out);
}

constexpr hn::CappedTag<double, 8> doubles;
constexpr hn::Rebind<float, decltype(doubles)> singles;
HWY_INLINE void store_as(hn::Vec<decltype(doubles)> v, double* to) {
  hn::StoreU(v, doubles, to);
}
HWY_INLINE void store_as(hn::Vec<decltype(doubles)> v, float* to) {
  hn::StoreU(hn::DemoteTo(singles, v), singles, to);
}

template <class T>
HWY_INLINE void scale_to(const ScaledSum& from, const LeafMask& active, T* HWY_RESTRICT to) {
  const auto scale = hn::Set(doubles, from.unit), mean = hn::Set(doubles, from.reference);
  for (std::size_t v = 0; v < leaf_size; v += hn::Lanes(doubles)) {
    auto value = hn::Mul(scale, hn::PromoteTo(doubles, hn::LoadU(singles, from.sum + v)));
    if (from.reference != 0)
      value = hn::MulAdd(mean, hn::PromoteTo(doubles, hn::LoadU(singles, from.weight + v)), value);
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(active.words[v / 64] >> (v % 64))};
    store_as(hn::IfThenElseZero(hn::LoadMaskBits(doubles, bits), value), to + v);
  }
}
void ScaleToDouble(const ScaledSum& from, const LeafMask& active, double* to) {
  scale_to(from, active, to);
}
void ScaleToSingle(const ScaledSum& from, const LeafMask& active, float* to) {
  scale_to(from, active, to);
}

void Narrow(const double* HWY_RESTRICT from, std::size_t count, float* HWY_RESTRICT to) {
  for (std::size_t v = 0; v < count; v += hn::Lanes(doubles)) store_as(hn::LoadU(doubles, from + v), to + v);
}

LeafMask FaintVoxels(const float* sum, float least, const float* plain, float rim, float enough,
                     const LeafMask& active) {
  const V small = hn::Set(d, least), edge = hn::Set(d, rim), plenty = hn::Set(d, enough);
  LeafMask faint;
  for (int v = 0; v < leaf_size; v += lanes) {
    const V p = hn::LoadU(d, plain + v);
    const auto few = hn::And(hn::Lt(hn::Abs(hn::LoadU(d, sum + v)), small), hn::Lt(p, plenty));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Or(hn::Lt(p, edge), few), bytes);
    const std::uint64_t bits = bytes[0] | static_cast<unsigned>(bytes[1]) << 8U;
    faint.words[static_cast<std::size_t>(v / 64)] |= bits << (v % 64);
  }
  for (std::size_t w = 0; w < faint.words.size(); ++w) faint.words[w] &= active.words[w];
  return faint;
}

float LeastOf(const float* values, const LeafMask& active) {
  V least = hn::Set(d, hwy::HighestValue<float>());
  for (int v = 0; v < leaf_size; v += lanes) {
    const std::uint64_t bits = active.words[static_cast<std::size_t>(v / 64)] >> (v % 64);
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U)};
    const V value = hn::LoadU(d, values + v);
    least = hn::IfThenElse(hn::LoadMaskBits(d, bytes), hn::Min(least, value), least);
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

template <class Tag>
void CountPart(const float* HWY_RESTRICT values, std::size_t stride, std::size_t count, Tag tag, const float* limit,
               float* few) {
  const auto least = hn::LoadU(tag, limit), one = hn::Set(tag, 1.0F);
  auto n = hn::Zero(tag);
  for (std::size_t k = 0; k < count; ++k)
    n = hn::Add(n, hn::IfThenElseZero(hn::Lt(hn::Abs(hn::LoadU(tag, values + k * stride)), least), one));
  hn::StoreU(n, tag, few);
}

void CountBelow(const float* values, std::size_t stride, std::size_t count, const float* limit, float* few) {
  const hn::CappedTag<float, 4> d4;  // records are padded to four
  std::size_t c = 0;
  for (; c + lanes <= stride; c += lanes) CountPart(values + c, stride, count, d, limit + c, few + c);
  for (; c < stride; c += hn::Lanes(d4)) CountPart(values + c, stride, count, d4, limit + c, few + c);
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
HWY_EXPORT(ScaleToDouble);
HWY_EXPORT(ScaleToSingle);
HWY_EXPORT(Narrow);
HWY_EXPORT(FaintVoxels);
HWY_EXPORT(LeastOf);
HWY_EXPORT(CountBelow);
HWY_EXPORT(TargetName);
void splat_leaf(const LeafSplat& leaf, const LeafMask& active, LeafSums& out) {
  HWY_DYNAMIC_DISPATCH(SplatLeaf)(leaf, active, out);
}
void scale_sums(const ScaledSum& from, const LeafMask& active, double* to) {
  HWY_DYNAMIC_DISPATCH(ScaleToDouble)(from, active, to);
}
void scale_sums(const ScaledSum& from, const LeafMask& active, float* to) {
  HWY_DYNAMIC_DISPATCH(ScaleToSingle)(from, active, to);
}
void narrow(const double* from, std::size_t count, float* to) {
  HWY_DYNAMIC_DISPATCH(Narrow)(from, count, to);
}
LeafMask faint_voxels(const float* sum, float least, const float* plain, float rim, float enough,
                      const LeafMask& active) {
  return HWY_DYNAMIC_DISPATCH(FaintVoxels)(sum, least, plain, rim, enough, active);
}
float least_of(const float* values, const LeafMask& active) {
  return HWY_DYNAMIC_DISPATCH(LeastOf)(values, active);
}
void count_below(const float* values, std::size_t stride, std::size_t count, const float* limit, float* few) {
  HWY_DYNAMIC_DISPATCH(CountBelow)(values, stride, count, limit, few);
}
const char* splat_target() {
  return HWY_DYNAMIC_DISPATCH(TargetName)();
}
}  // namespace grainvdb
#endif
