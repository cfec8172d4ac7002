#include <bit>

#include "splat/contact_bricks.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/contact_reach.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/branch_bricks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

void CollectBranches(const Buckets& buckets, std::span<const std::size_t> cells, const Coord& leaf, double to_cutoff,
                     double reach, LeafBranches& to) {
  const hn::RebindToUnsigned<D> du;
  const auto scale = hn::Set(d, static_cast<float>(to_cutoff));
  const CentredBox box{{0, 0, 0}, {3.5F * to.voxel, 3.5F * to.voxel, 3.5F * to.voxel}};
  const V reach2 = hn::Set(d, static_cast<float>(reach * reach) + touch);
  std::size_t n = 0;
  for (const std::size_t cell : cells) {
    const std::size_t first = buckets.start[cell], count = buckets.start[cell + 1] - first;
    const float* const local[3] = {buckets.local[0].data() + first, buckets.local[1].data() + first,
                                   buckets.local[2].data() + first};
    V from_leaf[3];
    for (int a = 0; a < 3; ++a)
      from_leaf[a] = hn::Set(d, static_cast<float>((buckets.cells[cell][a] - leaf[a]) * to_cutoff));
    auto entry = hn::Iota(du, static_cast<std::uint32_t>(first));
    for (std::size_t i = 0; i < count; i += lanes) {
      const V x = hn::MulAdd(hn::LoadU(d, local[0] + i), scale, from_leaf[0]);
      const V y = hn::MulAdd(hn::LoadU(d, local[1] + i), scale, from_leaf[1]);
      const V z = hn::MulAdd(hn::LoadU(d, local[2] + i), scale, from_leaf[2]);
      const V dx = beyond(x, 0, box.half[0]), dy = beyond(y, 0, box.half[1]), dz = beyond(z, 0, box.half[2]);
      auto near = hn::Lt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), reach2);
      if (i + lanes > count) near = hn::And(near, hn::FirstN(d, count - i));
      store_some(x, near, d, to.x.data() + n);
      store_some(y, near, d, to.y.data() + n);
      store_some(z, near, d, to.z.data() + n);
      n += store_some(entry, hn::RebindMask(du, near), du, to.entry.data() + n);
      entry = hn::Add(entry, hn::Set(du, static_cast<std::uint32_t>(lanes)));
    }
  }
  to.entry.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const float* arm = to.records + to.entry[k] * to.stride;
    to.ax[k] = arm[0];
    to.ay[k] = arm[1];
    to.az[k] = arm[2];
    to.arm2[k] = arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2];
  }
}

/// Squared distances of voxels from a branch.
HWY_INLINE V distance2(const LeafBranches& b, std::size_t i, const Voxels& at) {
  const V ax = hn::Set(d, b.ax[i]), ay = hn::Set(d, b.ay[i]), az = hn::Set(d, b.az[i]);
  const V dx = hn::Sub(at.x, hn::Set(d, b.x[i])), dy = hn::Sub(at.y, hn::Set(d, b.y[i])),
          dz = hn::Sub(at.z, hn::Set(d, b.z[i]));
  const V half = hn::Set(d, 0.5F);
  const V foot =
      hn::Mul(hn::MulAdd(dx, ax, hn::MulAdd(dy, ay, hn::Mul(dz, az))), hn::Set(d, b.arm2[i] > 0 ? 1 / b.arm2[i] : 0));
  const V s = hn::Max(hn::Min(foot, half), hn::Neg(half));
  const V ex = hn::NegMulAdd(s, ax, dx), ey = hn::NegMulAdd(s, ay, dy), ez = hn::NegMulAdd(s, az, dz);
  return hn::MulAdd(ex, ex, hn::MulAdd(ey, ey, hn::Mul(ez, ez)));
}

HWY_INLINE std::uint32_t bits_of(hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}

void ReachOfBranches(const LeafBranches& leaf, const LeafMask& window, BranchScratch& scratch, LeafMask& mask,
                     std::vector<DoubtfulVoxel>& doubtful) {
  const float h = leaf.voxel;
  scratch.chosen.resize(leaf.size() + 2 * lanes);
  std::int32_t* const chosen = scratch.chosen.data();
  const V surely = hn::Set(d, 1 - touch), perhaps = hn::Set(d, 1 + touch);
  for_each_brick_of_leaf([&](const VoxelBox& brick) {
    const std::uint32_t wanted = brick_bits(window, brick);
    std::uint32_t found = brick_bits(mask, brick);
    if ((wanted & ~found) == 0) return;
    const std::size_t n = pick_branches(leaf, 0, leaf.size(), centres_of(brick, brick_x, brick_y, brick_z, h), chosen);
    const Voxels at = brick_voxels(brick, h);
    for (std::size_t k = 0; k < n && (wanted & ~found) != 0; ++k) {
      const auto i = static_cast<std::size_t>(chosen[k]);
      const V r2 = distance2(leaf, i, at);
      found |= bits_of(hn::Lt(r2, surely)) & wanted;
      std::uint32_t open = bits_of(hn::Lt(r2, perhaps)) & wanted & ~found;
      for (; open != 0; open &= open - 1)
        doubtful.push_back({leaf.entry[i], lane_offset(brick, std::countr_zero(open))});
    }
    set_brick_bits(mask, brick, found);
  });
}

void BranchesAtVoxel(const LeafBranches& leaf, int offset, std::vector<std::int32_t>& out) {
  const VoxelBox voxel{offset >> 6, (offset >> 3) & 7, offset & 7, 1};
  out.resize(leaf.size() + 2 * lanes);
  // For a single point the bound of pick_branches is nearly the distance from the branch.
  out.resize(pick_branches(leaf, 0, leaf.size(), centres_of(voxel, 1, 1, 1, leaf.voxel), out.data()));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(CollectBranches);
HWY_EXPORT(ReachOfBranches);
HWY_EXPORT(BranchesAtVoxel);
void collect_branches(const Buckets& buckets, std::span<const std::size_t> cells, const Coord& leaf, double to_cutoff,
                      double reach, LeafBranches& to) {
  std::size_t most = 0;
  for (const std::size_t cell : cells) most += buckets.start[cell + 1] - buckets.start[cell];
  to.x.room(most);
  to.y.room(most);
  to.z.room(most);
  to.ax.room(most);
  to.ay.room(most);
  to.az.room(most);
  to.arm2.room(most);
  to.entry.resize(most + Grow<float>::slack);
  HWY_DYNAMIC_DISPATCH(CollectBranches)(buckets, cells, leaf, to_cutoff, reach, to);
}
void reach_of_branches(const LeafBranches& leaf, const LeafMask& window, BranchScratch& scratch, LeafMask& mask,
                       std::vector<DoubtfulVoxel>& doubtful) {
  HWY_DYNAMIC_DISPATCH(ReachOfBranches)(leaf, window, scratch, mask, doubtful);
}
void branches_at_voxel(const LeafBranches& leaf, int offset, std::vector<std::int32_t>& out) {
  HWY_DYNAMIC_DISPATCH(BranchesAtVoxel)(leaf, offset, out);
}
}  // namespace grainvdb
#endif
