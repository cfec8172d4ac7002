// The candidates of the blocks of a leaf, compiled once for every instruction set (see bricks-inl.hpp).
#if defined(GRAINVDB_SPLAT_BLOCKS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_BLOCKS_INL_HPP
#undef GRAINVDB_SPLAT_BLOCKS_INL_HPP
#else
#define GRAINVDB_SPLAT_BLOCKS_INL_HPP
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "splat/bricks-inl.hpp"
#include "splat/candidates.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {

/// Squared distances along one axis from parts of `size` voxels, one after the other.
template <int size, int parts>
struct Beyond {
  static constexpr int count = parts;
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

/// The candidates of all blocks of a leaf. Distances along one axis are the same for four of them.
inline HWY_NOINLINE void pick_blocks(const LeafCandidates& all, float h, NearBlocks& out) {
  const Beyond<block, 2> along(0, h);
  float *x[leaf_blocks], *y[leaf_blocks], *z[leaf_blocks];
  std::int32_t* at[leaf_blocks];
  for (std::size_t b = 0; b < out.size(); ++b) {
    x[b] = out[b].x.room(all.count);
    y[b] = out[b].y.room(all.count);
    z[b] = out[b].z.room(all.count);
    at[b] = out[b].at.room(all.count);
    out[b].count = 0;
  }
  const V limit = hn::Set(d, 1 + margin);
  auto place = hn::Iota(di, 0);
  for (std::size_t i = 0; i < all.count; i += lanes, place = hn::Add(place, hn::Set(di, lanes))) {
    const Voxels v{hn::Load(d, all.x.data() + i), hn::Load(d, all.y.data() + i), hn::Load(d, all.z.data() + i)};
    const auto valid = hn::FirstN(d, all.count - i);
    V dx[2], dy[2], dz[2];
    along(v.x, dx);
    along(v.y, dy);
    along(v.z, dz);
    for (std::size_t b = 0; b < out.size(); ++b) {
      const V r2 = hn::Add(hn::Add(dx[b / 4], dy[b / 2 % 2]), dz[b % 2]);
      const auto near = hn::And(hn::Lt(r2, limit), valid);
      if (hn::AllFalse(d, near)) continue;
      const std::size_t n = out[b].count;
      store_some(v.x, near, d, x[b] + n);
      store_some(v.y, near, d, y[b] + n);
      store_some(v.z, near, d, z[b] + n);
      out[b].count += store_some(place, hn::RebindMask(di, near), di, at[b] + n);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
