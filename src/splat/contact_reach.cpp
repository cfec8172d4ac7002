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
      hn::CompressStore(x, near, d, to.x.data() + n);
      hn::CompressStore(y, near, d, to.y.data() + n);
      hn::CompressStore(z, near, d, to.z.data() + n);
      n += hn::CompressStore(entry, hn::RebindMask(du, near), du, to.entry.data() + n);
      entry = hn::Add(entry, hn::Set(du, static_cast<std::uint32_t>(lanes)));
    }
  }
  to.entry.resize(n);
}

/// Squared distances of a brick's voxels from branch i of the block.
HWY_INLINE V distance2(const BranchScratch& b, std::size_t i, V px, V py, V pz) {
  const V ax = hn::Set(d, b.ax.data()[i]), ay = hn::Set(d, b.ay.data()[i]), az = hn::Set(d, b.az.data()[i]);
  const V dx = hn::Sub(px, hn::Set(d, b.x.data()[i])), dy = hn::Sub(py, hn::Set(d, b.y.data()[i])),
          dz = hn::Sub(pz, hn::Set(d, b.z.data()[i]));
  const float arm2 = b.arm2.data()[i];
  const V half = hn::Set(d, 0.5F);
  const V foot = hn::Mul(hn::MulAdd(dx, ax, hn::MulAdd(dy, ay, hn::Mul(dz, az))), hn::Set(d, arm2 > 0 ? 1 / arm2 : 0));
  const V s = hn::Max(hn::Min(foot, half), hn::Neg(half));
  const V ex = hn::NegMulAdd(s, ax, dx), ey = hn::NegMulAdd(s, ay, dy), ez = hn::NegMulAdd(s, az, dz);
  return hn::MulAdd(ex, ex, hn::MulAdd(ey, ey, hn::Mul(ez, ez)));
}

HWY_INLINE std::uint32_t bits_of(hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}

void ReachOfBranches(const LeafBranches& leaf, float half_arm, const LeafMask& window, BranchScratch& scratch,
                     LeafMask& mask, std::vector<DoubtfulVoxel>& doubtful) {
  const float h = leaf.voxel;
  const BrickOffsets offsets(h);
  const V ox = hn::Load(d, offsets.at[0]), oy = hn::Load(d, offsets.at[1]), oz = hn::Load(d, offsets.at[2]);
  scratch.chosen.resize(leaf.size() + 2 * lanes);
  scratch.in_brick.resize(leaf.size() + 2 * lanes);
  for (Grow<float>* room : {&scratch.x, &scratch.y, &scratch.z, &scratch.ax, &scratch.ay, &scratch.az, &scratch.arm2})
    room->room(leaf.size());
  const V surely = hn::Set(d, 1 - touch), perhaps = hn::Set(d, 1 + touch);

  for (int bx = 0; bx < leaf_edge; bx += block)
    for (int by = 0; by < leaf_edge; by += block)
      for (int bz = 0; bz < leaf_edge; bz += block) {
        const CentredBox box = block_box(h, bx, by, bz);
        std::size_t count = 0;
        bool loaded = false;
        for (int x = 0; x < block; x += brick_x)
          for (int y = 0; y < block; y += brick_y)
            for (int z = 0; z < block; z += brick_z) {
              const std::uint32_t wanted = brick_bits(window, bx + x, by + y, bz + z);
              std::uint32_t found = brick_bits(mask, bx + x, by + y, bz + z);
              if ((wanted & ~found) == 0) continue;
              if (!loaded) {
                loaded = true;
                count = pick_middles(leaf.x.data(), leaf.y.data(), leaf.z.data(), 0, leaf.size(), box,
                                     1 + half_arm + touch, scratch.chosen.data());
                for (std::size_t k = 0; k < count; ++k) {
                  const auto i = static_cast<std::size_t>(scratch.chosen[k]);
                  const float* arm = leaf.records + leaf.entry[i] * leaf.stride;
                  scratch.x.data()[k] = leaf.x.data()[i] - box.middle[0];
                  scratch.y.data()[k] = leaf.y.data()[i] - box.middle[1];
                  scratch.z.data()[k] = leaf.z.data()[i] - box.middle[2];
                  scratch.ax.data()[k] = arm[0];
                  scratch.ay.data()[k] = arm[1];
                  scratch.az.data()[k] = arm[2];
                  scratch.arm2.data()[k] = arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2];
                }
              }
              const CentredBox brick = brick_box(h, x, y, z);
              const std::size_t n = pick_branches(scratch, count, brick, scratch.in_brick.data());
              const V px = hn::Add(ox, hn::Set(d, brick.middle[0] - brick.half[0]));
              const V py = hn::Add(oy, hn::Set(d, brick.middle[1] - brick.half[1]));
              const V pz = hn::Add(oz, hn::Set(d, brick.middle[2] - brick.half[2]));
              for (std::size_t k = 0; k < n && (wanted & ~found) != 0; ++k) {
                const auto i = static_cast<std::size_t>(scratch.in_brick[k]);
                const V r2 = distance2(scratch, i, px, py, pz);
                found |= bits_of(hn::Lt(r2, surely)) & wanted;
                std::uint32_t open = bits_of(hn::Lt(r2, perhaps)) & wanted & ~found;
                for (; open != 0; open &= open - 1)
                  doubtful.push_back({leaf.entry[static_cast<std::size_t>(scratch.chosen[i])],
                                      lane_offset(bx + x, by + y, bz + z, std::countr_zero(open))});
              }
              set_brick_bits(mask, bx + x, by + y, bz + z, found);
            }
      }
}

void BranchesAtVoxel(const LeafBranches& leaf, float half_arm, int offset, std::vector<std::int32_t>& out) {
  const float h = leaf.voxel;
  const CentredBox voxel{{h * (static_cast<float>(offset >> 6) - 3.5F), h * (static_cast<float>((offset >> 3) & 7) - 3.5F),
                          h * (static_cast<float>(offset & 7) - 3.5F)},
                         {0, 0, 0}};
  out.resize(leaf.size() + 2 * lanes);
  out.resize(pick_middles(leaf.x.data(), leaf.y.data(), leaf.z.data(), 0, leaf.size(), voxel, 1 + half_arm + touch,
                          out.data()));
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
  to.entry.resize(most + Grow<float>::slack);
  HWY_DYNAMIC_DISPATCH(CollectBranches)(buckets, cells, leaf, to_cutoff, reach, to);
}
void reach_of_branches(const LeafBranches& leaf, float half_arm, const LeafMask& window, BranchScratch& scratch,
                       LeafMask& mask, std::vector<DoubtfulVoxel>& doubtful) {
  HWY_DYNAMIC_DISPATCH(ReachOfBranches)(leaf, half_arm, window, scratch, mask, doubtful);
}
void branches_at_voxel(const LeafBranches& leaf, float half_arm, int offset, std::vector<std::int32_t>& out) {
  HWY_DYNAMIC_DISPATCH(BranchesAtVoxel)(leaf, half_arm, offset, out);
}
}  // namespace grainvdb
#endif
