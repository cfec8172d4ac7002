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

/// The candidates whose middle lies within `reach` of the box, in their order.
HWY_INLINE std::size_t pick_middles(const LeafBranches& leaf, const CentredBox& box, float reach,
                                    std::int32_t* HWY_RESTRICT out) {
  const V reach2 = hn::Set(d, reach * reach);
  std::size_t n = 0;
  auto index = hn::Iota(di, 0);
  const auto step = hn::Set(di, lanes);
  for (std::size_t i = 0; i < leaf.size(); i += lanes, index = hn::Add(index, step)) {
    const V dx = beyond(hn::Load(d, leaf.x.data() + i), box.middle[0], box.half[0]);
    const V dy = beyond(hn::Load(d, leaf.y.data() + i), box.middle[1], box.half[1]);
    const V dz = beyond(hn::Load(d, leaf.z.data() + i), box.middle[2], box.half[2]);
    auto near = hn::Lt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), reach2);
    if (i + lanes > leaf.size()) near = hn::And(near, hn::FirstN(d, leaf.size() - i));
    n += store_some(index, hn::RebindMask(di, near), di, out + n);
  }
  return n;
}

/// Those of the candidates begin … end-1 with a point within 1 of the box, in their order, and few others. The distance
/// f of a point of the branch from the box is a convex function of its place s on the arm, so it is nowhere below its
/// tangent in the middle, f + s n·a with n the direction from the box: branches are left out where f - |n·a|/2 ≥ 1.
HWY_INLINE std::size_t pick_branches(const LeafBranches& leaf, std::size_t begin, std::size_t end,
                                     const CentredBox& box, std::int32_t* HWY_RESTRICT out) {
  const V half = hn::Set(d, 0.5F), slack = hn::Set(d, touch);
  std::size_t n = 0;
  auto index = hn::Iota(di, static_cast<std::int32_t>(begin));
  const auto step = hn::Set(di, lanes);
  for (std::size_t i = begin; i < end; i += lanes, index = hn::Add(index, step)) {
    const V dx = beyond(hn::LoadU(d, leaf.x.data() + i), box.middle[0], box.half[0]);
    const V dy = beyond(hn::LoadU(d, leaf.y.data() + i), box.middle[1], box.half[1]);
    const V dz = beyond(hn::LoadU(d, leaf.z.data() + i), box.middle[2], box.half[2]);
    const V f2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const V fna =
        hn::MulAdd(dx, hn::LoadU(d, leaf.ax.data() + i),
                   hn::MulAdd(dy, hn::LoadU(d, leaf.ay.data() + i), hn::Mul(dz, hn::LoadU(d, leaf.az.data() + i))));
    auto near = hn::Lt(hn::NegMulAdd(half, hn::Abs(fna), f2), hn::Add(hn::Sqrt(f2), slack));
    if (i + lanes > end) near = hn::And(near, hn::FirstN(d, end - i));
    n += store_some(index, hn::RebindMask(di, near), di, out + n);
  }
  return n;
}

/// The box of the centres of nx × ny × nz voxels.
HWY_INLINE CentredBox centres_of(const VoxelBox& first, int nx, int ny, int nz, float h) {
  const auto middle = [h](int at, int n) {
    return h * (static_cast<float>(at) + 0.5F * static_cast<float>(n - 1) - 3.5F);
  };
  const auto half = [h](int n) { return 0.5F * h * static_cast<float>(n - 1); };
  return {{middle(first.x, nx), middle(first.y, ny), middle(first.z, nz)}, {half(nx), half(ny), half(nz)}};
}

/// Calls f for the bricks of a leaf, those of one block after another.
template <class F>
HWY_INLINE void for_each_brick_of_leaf(const F& f) {
  for (int b = 0; b < leaf_blocks; ++b) for_each_brick(block_box(b), f);
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
