// What the kernels for branches share, compiled once for every instruction set (see bricks-inl.hpp).
#if defined(GRAINVDB_SPLAT_BRANCH_BRICKS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_BRANCH_BRICKS_INL_HPP
#undef GRAINVDB_SPLAT_BRANCH_BRICKS_INL_HPP
#else
#define GRAINVDB_SPLAT_BRANCH_BRICKS_INL_HPP
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "splat/bricks-inl.hpp"
#include "splat/contact_bricks.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Single precision moves points by a few 1e-7: what touches by less than this is still a candidate.
constexpr float touch = 1e-5F;

/// A box of voxel centres.
struct CentredBox {
  float middle[3];
  float half[3];
};

/// How far the points lie outside the box along one axis, with sign.
HWY_INLINE V beyond(V x, float middle, float half) {
  const V from = hn::Sub(x, hn::Set(d, middle));
  return hn::CopySign(hn::Max(hn::Sub(hn::Abs(from), hn::Set(d, half)), hn::Zero(d)), from);
}

/// The candidates `begin` … `end`-1 whose middle lies within `reach` of the box, in their order.
HWY_INLINE std::size_t pick_middles(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                                    const float* HWY_RESTRICT z, std::size_t begin, std::size_t end,
                                    const CentredBox& box, float reach, std::int32_t* HWY_RESTRICT out) {
  const V reach2 = hn::Set(d, reach * reach);
  std::size_t n = 0;
  auto index = hn::Iota(di, static_cast<std::int32_t>(begin));
  const auto step = hn::Set(di, lanes);
  for (std::size_t i = begin; i < end; i += lanes, index = hn::Add(index, step)) {
    const V dx = beyond(hn::LoadU(d, x + i), box.middle[0], box.half[0]);
    const V dy = beyond(hn::LoadU(d, y + i), box.middle[1], box.half[1]);
    const V dz = beyond(hn::LoadU(d, z + i), box.middle[2], box.half[2]);
    auto near = hn::Lt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), reach2);
    if (i + lanes > end) near = hn::And(near, hn::FirstN(d, end - i));
    n += hn::CompressStore(index, hn::RebindMask(di, near), di, out + n);
  }
  return n;
}

/// The branches of a block with a point within 1 of the box, in their order, and few others. The distance f of a point
/// of the branch from the box is a convex function of its place s on the arm, so it is nowhere below its tangent in the
/// middle, f - |s n·a| with n the direction from the box: branches are left out where f - |n·a|/2 ≥ 1.
HWY_INLINE std::size_t pick_branches(const BranchScratch& b, std::size_t count, const CentredBox& box,
                                     std::int32_t* HWY_RESTRICT out) {
  const V half = hn::Set(d, 0.5F), slack = hn::Set(d, touch);
  std::size_t n = 0;
  auto index = hn::Iota(di, 0);
  const auto step = hn::Set(di, lanes);
  for (std::size_t i = 0; i < count; i += lanes, index = hn::Add(index, step)) {
    const V dx = beyond(hn::Load(d, b.x.data() + i), box.middle[0], box.half[0]);
    const V dy = beyond(hn::Load(d, b.y.data() + i), box.middle[1], box.half[1]);
    const V dz = beyond(hn::Load(d, b.z.data() + i), box.middle[2], box.half[2]);
    const V f2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const V fna =
        hn::MulAdd(dx, hn::Load(d, b.ax.data() + i),
                   hn::MulAdd(dy, hn::Load(d, b.ay.data() + i), hn::Mul(dz, hn::Load(d, b.az.data() + i))));
    auto near = hn::Lt(hn::NegMulAdd(half, hn::Abs(fna), f2), hn::Add(hn::Sqrt(f2), slack));
    if (i + lanes > count) near = hn::And(near, hn::FirstN(d, count - i));
    n += hn::CompressStore(index, hn::RebindMask(di, near), di, out + n);
  }
  return n;
}

/// The voxel positions of a brick relative to its first voxel.
struct BrickOffsets {
  explicit BrickOffsets(float h) {
    for (int l = 0; l < lanes; ++l) {
      at[0][l] = h * static_cast<float>(l / (brick_y * brick_z));
      at[1][l] = h * static_cast<float>(l / brick_z % brick_y);
      at[2][l] = h * static_cast<float>(l % brick_z);
    }
  }
  HWY_ALIGN float at[3][lanes];
};

/// The middle of a block of voxels whose first has the given coordinates in the leaf.
HWY_INLINE CentredBox block_box(float h, int x, int y, int z) {
  constexpr float to_middle = 0.5F * (block - leaf_edge);
  const float half = 0.5F * h * (block - 1);
  return {{h * (static_cast<float>(x) + to_middle), h * (static_cast<float>(y) + to_middle),
           h * (static_cast<float>(z) + to_middle)},
          {half, half, half}};
}

/// A brick whose first voxel has the given coordinates in its block, relative to the middle of the block.
HWY_INLINE CentredBox brick_box(float h, int x, int y, int z) {
  const float half = 0.5F * (block - 1);
  return {{h * (static_cast<float>(x) + 0.5F * (brick_x - 1) - half),
           h * (static_cast<float>(y) + 0.5F * (brick_y - 1) - half),
           h * (static_cast<float>(z) + 0.5F * (brick_z - 1) - half)},
          {0.5F * h * (brick_x - 1), 0.5F * h * (brick_y - 1), 0.5F * h * (brick_z - 1)}};
}

/// The bits of a brick's voxels in a mask, lane by lane, and back.
HWY_INLINE std::uint32_t brick_bits(const LeafMask& mask, int x, int y, int z) {
  std::uint32_t bits = 0;
  for (int i = 0; i < brick_x; ++i)
    for (int j = 0; j < brick_y; ++j) {
      const std::uint64_t row = mask.words[static_cast<std::size_t>(x + i)] >> ((y + j) * 8 + z);
      bits |= (static_cast<std::uint32_t>(row) & ((1U << brick_z) - 1U)) << ((i * brick_y + j) * brick_z);
    }
  return bits;
}
HWY_INLINE void set_brick_bits(LeafMask& mask, int x, int y, int z, std::uint32_t bits) {
  for (int i = 0; i < brick_x; ++i)
    for (int j = 0; j < brick_y; ++j) {
      const std::uint64_t row = (bits >> ((i * brick_y + j) * brick_z)) & ((1U << brick_z) - 1U);
      mask.words[static_cast<std::size_t>(x + i)] |= row << ((y + j) * 8 + z);
    }
}
HWY_INLINE int lane_offset(int x, int y, int z, int lane) {
  return (x + lane / (brick_y * brick_z)) * 64 + (y + lane / brick_z % brick_y) * 8 + z + lane % brick_z;
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
