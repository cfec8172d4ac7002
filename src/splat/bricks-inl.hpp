// What the brick kernels share, compiled once for every instruction set: include it from files that
// hwy/foreach_target.h compiles again and again, after hwy/highway.h.
#if defined(GRAINVDB_SPLAT_BRICKS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_BRICKS_INL_HPP
#undef GRAINVDB_SPLAT_BRICKS_INL_HPP
#else
#define GRAINVDB_SPLAT_BRICKS_INL_HPP
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <hwy/highway.h>

#include "splat/candidates.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
constexpr D d;
constexpr DI di;

/// A brick is the block of voxels that fills a register: 2×2×(N/4), or one voxel without vectors.
template <class Tag>
struct Brick {
  static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
  static constexpr int x = lanes >= 4 ? 2 : 1, y = x, z = lanes / (x * y);
};
constexpr int lanes = Brick<D>::lanes;
constexpr int brick_x = Brick<D>::x, brick_y = Brick<D>::y, brick_z = Brick<D>::z;
constexpr int block = 4;  // voxels along the edge of a block, whose candidates are picked once for its bricks

/// Squared distances, in units of the cutoff, carry the rounding of three positions (2e-7 each) and of their squares.
constexpr float margin = 4e-6F;

/// The voxel centres of a brick, relative to the leaf's centre.
template <class Tag>
struct VoxelsOf {
  hn::Vec<Tag> x, y, z;
};
using Voxels = VoxelsOf<D>;
template <class Tag>
HWY_INLINE VoxelsOf<Tag> brick_voxels_of(Tag tag, const VoxelBox& brick, float h) {
  using B = Brick<Tag>;
  HWY_ALIGN static constexpr auto steps = [] {
    std::array<std::array<float, B::lanes>, 3> at{};
    for (int l = 0; l < B::lanes; ++l) {
      at[0][static_cast<std::size_t>(l)] = static_cast<float>(l / (B::y * B::z)) - 3.5F;
      at[1][static_cast<std::size_t>(l)] = static_cast<float>(l / B::z % B::y) - 3.5F;
      at[2][static_cast<std::size_t>(l)] = static_cast<float>(l % B::z) - 3.5F;
    }
    return at;
  }();
  const auto along = [&](int axis, int first) {
    const auto step = hn::LoadU(tag, steps[static_cast<std::size_t>(axis)].data());
    return hn::Mul(hn::Set(tag, h), hn::Add(step, hn::Set(tag, static_cast<float>(first))));
  };
  return {along(0, brick.x), along(1, brick.y), along(2, brick.z)};
}
HWY_INLINE Voxels brick_voxels(const VoxelBox& brick, float h) {
  return brick_voxels_of(d, brick, h);
}

/// A block by its number.
constexpr VoxelBox block_box(int number) {
  return {number / 4 * block, number / 2 % 2 * block, number % 2 * block, block};
}

/// Calls f for the bricks of a box, in ascending order of x, y, z.
template <class Tag = D, class F>
HWY_INLINE void for_each_brick(const VoxelBox& box, const F& f) {
  using B = Brick<Tag>;
  for (int x = box.x; x < box.x + box.edge; x += B::x)
    for (int y = box.y; y < box.y + box.edge; y += B::y)
      for (int z = box.z; z < box.z + box.edge; z += B::z) f(VoxelBox{x, y, z});
}

/// The bits of a brick's voxels in a mask, lane by lane, and back.
template <class Tag = D>
HWY_INLINE std::uint32_t brick_bits(const LeafMask& mask, const VoxelBox& brick) {
  using B = Brick<Tag>;
  std::uint32_t bits = 0;
  for (int i = 0; i < B::x; ++i)
    for (int j = 0; j < B::y; ++j) {
      const std::uint64_t row = mask.words[static_cast<std::size_t>(brick.x + i)] >> ((brick.y + j) * 8 + brick.z);
      bits |= (static_cast<std::uint32_t>(row) & ((1U << B::z) - 1U)) << ((i * B::y + j) * B::z);
    }
  return bits;
}
HWY_INLINE void set_brick_bits(LeafMask& mask, const VoxelBox& brick, std::uint32_t bits) {
  for (int i = 0; i < brick_x; ++i)
    for (int j = 0; j < brick_y; ++j) {
      const std::uint64_t row = (bits >> ((i * brick_y + j) * brick_z)) & ((1U << brick_z) - 1U);
      mask.words[static_cast<std::size_t>(brick.x + i)] |= row << ((brick.y + j) * 8 + brick.z);
    }
}
template <class Tag = D>
HWY_INLINE int lane_offset(const VoxelBox& brick, int lane) {
  using B = Brick<Tag>;
  return (brick.x + lane / (B::y * B::z)) * 64 + (brick.y + lane / B::z % B::y) * 8 + brick.z + lane % B::z;
}

/// Where the sums of a brick are among those of its leaf, see BrickSums.
template <class Tag = D>
HWY_INLINE std::size_t brick_number(const VoxelBox& brick) {
  using B = Brick<Tag>;
  return static_cast<std::size_t>(((brick.x / B::x) * (leaf_edge / B::y) + brick.y / B::y) * (leaf_edge / B::z) +
                                  brick.z / B::z);
}

/// The lanes of a mask as bits.
template <class Tag>
HWY_INLINE std::uint32_t bits_of(Tag tag, hn::Mask<Tag> lanes_set) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, lanes_set, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8U;
}

/// The box of the centres of some voxels, and the squared distance from it below which candidates are picked.
struct BoxTest {
  float middle[3];
  float half[3];
  float limit;
};

/// Which of the first `count` lanes pass.
HWY_INLINE hn::Mask<D> near_box(const Voxels& v, const BoxTest& box, std::size_t count) {
  const auto beyond = [&](V x, int axis) {
    return hn::Max(hn::Sub(hn::Abs(hn::Sub(x, hn::Set(d, box.middle[axis]))), hn::Set(d, box.half[axis])), hn::Zero(d));
  };
  const V dx = beyond(v.x, 0), dy = beyond(v.y, 1), dz = beyond(v.z, 2);
  const auto near = hn::Lt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), hn::Set(d, box.limit));
  return count < lanes ? hn::And(near, hn::FirstN(d, count)) : near;
}

// Tables for compressing four and eight lanes, where there is no instruction for it. Highway's own are copied to the
// stack with every use when GCC 12 compiles them, which takes longer than all the rest.
/// The lanes of a mask of eight, the first in the lowest four bits.
inline constexpr auto lanes_of_eight = [] {
  std::array<std::uint32_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (unsigned lane = 0, n = 0; lane < 8; ++lane)
      if ((mask >> lane & 1U) != 0) table[mask] |= lane << (4 * n++);
  return table;
}();
/// The bytes of the lanes of a mask of four.
alignas(16) inline constexpr auto bytes_of_four = [] {
  std::array<std::array<std::uint8_t, 16>, 16> table{};
  for (unsigned mask = 0; mask < 16; ++mask)
    for (unsigned lane = 0, n = 0; lane < 4; ++lane)
      if ((mask >> lane & 1U) != 0)
        for (unsigned byte = 0; byte < 4; ++byte) table[mask][n++] = static_cast<std::uint8_t>(4 * lane + byte);
  return table;
}();

/// The lanes of the mask one after another, and anything behind them.
template <class Tag>
HWY_INLINE hn::Vec<Tag> compress(Tag tag, hn::Vec<Tag> v, hn::Mask<Tag> some) {
  constexpr int width = Brick<Tag>::lanes;
  if constexpr (width == 8 || width == 4) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(tag, some, bits);
    if constexpr (width == 8) {
      const hn::RebindToUnsigned<Tag> numbers;
      HWY_ALIGN static constexpr std::uint32_t shifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
      const auto packed = hn::Set(numbers, lanes_of_eight[bits[0]]);
      const auto places = hn::And(hn::Shr(packed, hn::Load(numbers, shifts)), hn::Set(numbers, 7));
      return hn::TableLookupLanes(v, hn::IndicesFromVec(tag, places));
    } else {
      const hn::Repartition<std::uint8_t, Tag> bytes;
      return hn::BitCast(
          tag, hn::TableLookupBytes(hn::BitCast(bytes, v), hn::Load(bytes, bytes_of_four[bits[0] & 15U].data())));
    }
  } else {
    return hn::Compress(v, some);
  }
}

/// Stores the lanes of the mask one after another, and leaves garbage behind them. Returns their number. Compressing
/// into a register and storing all of it is faster than a masked store to memory.
template <class Tag, class Lanes, class Mask>
HWY_INLINE std::size_t store_some(Lanes v, Mask some, Tag tag, hn::TFromD<Tag>* to) {
  hn::StoreU(compress(tag, v, some), tag, to);
  return hn::CountTrue(tag, some);
}

/// Values of a candidate are kept in records of a multiple of four.
constexpr std::size_t record_stride(std::size_t channels) {
  return (channels + 3) / 4 * 4;
}

/// sums[channel][lane] = Σ_k weights[k][lane] q[chosen[k]][channel], all sums in registers. `fixed_stride` is the
/// stride of q, or 0 when it is only known at run time.
///
/// A multiplication takes a broadcast of one value from memory, and the processor loads as many as it multiplies: with
/// the weight and the place that is more than it can load. So with 16 lanes the last few values come from one load of
/// the record and permutations, which other ports do.
template <int channels, std::size_t fixed_stride>
HWY_NOINLINE void sum_channels(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT q, std::size_t stride,
                               const std::int32_t* HWY_RESTRICT chosen, std::size_t count, float* HWY_RESTRICT sums) {
  constexpr int permuted = lanes == 16 && channels <= 16 ? (channels / 3 < 4 ? channels / 3 : 4) : 0;
  constexpr int loaded = channels - permuted;
  V s[channels];
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) s[c] = hn::Zero(d);
  for (std::size_t k = 0; k < count; ++k) {
    const V w = hn::Load(d, weights + k * lanes);
    const float* HWY_RESTRICT v = q + static_cast<std::size_t>(chosen[k]) * (fixed_stride == 0 ? stride : fixed_stride);
#pragma GCC unroll 32
    for (int c = 0; c < loaded; ++c) s[c] = hn::MulAdd(w, hn::Set(d, v[c]), s[c]);
    if constexpr (permuted > 0) {
      const V record = hn::LoadU(d, v);
#pragma GCC unroll 32
      for (int c = loaded; c < channels; ++c)
        s[c] = hn::MulAdd(w, hn::TableLookupLanes(record, hn::IndicesFromVec(d, hn::Set(di, c))), s[c]);
    }
  }
#pragma GCC unroll 32
  for (int c = 0; c < channels; ++c) hn::Store(s[c], d, sums + c * lanes);
}

using Sum = void (*)(const float*, const float*, std::size_t, const std::int32_t*, std::size_t, float*);
// Accumulators that fit the registers (16, or 32 with AVX-512) beside the weight and the broadcast.
constexpr int widest = lanes == 16 ? 24 : 14;

template <bool stride_known, int... c>
constexpr std::array<Sum, sizeof...(c) + 1> sums_for(std::integer_sequence<int, c...>) {
  return {nullptr, sum_channels < c + 1, stride_known ? record_stride(c + 1) : 0 > ...};
}
constexpr auto sum_of_record = sums_for<true>(std::make_integer_sequence<int, widest>());
constexpr auto sum_of_part = sums_for<false>(std::make_integer_sequence<int, widest>());

/// The sum over `channels` of the values in records of `stride`.
HWY_INLINE Sum sum_of(std::size_t channels, std::size_t stride) {
  return (record_stride(channels) == stride ? sum_of_record : sum_of_part)[channels];
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
