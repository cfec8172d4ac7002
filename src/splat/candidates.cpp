#include "splat/candidates.hpp"

#include <algorithm>

#include "splat/gather.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/candidates.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/blocks-inl.hpp"
#include "splat/bricks-inl.hpp"

#ifndef GRAINVDB_SPLAT_CELL_SCAN
#define GRAINVDB_SPLAT_CELL_SCAN
namespace grainvdb {

// Some of a cell's entries, and how their positions become those of candidates: x = local · scale + offset.
struct CellScan {
  const float *x, *y, *z;
  std::size_t count;
  std::uint32_t first;
  float scale;
  float offset[3];
};

}  // namespace grainvdb
#endif

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

void ScanCell(const CellScan& cell, float half, LeafCandidates& out) {
  const hn::RebindToUnsigned<D> du;
  const V scale = hn::Set(d, cell.scale), reach = hn::Set(d, half), zero = hn::Zero(d);
  const V ox = hn::Set(d, cell.offset[0]), oy = hn::Set(d, cell.offset[1]), oz = hn::Set(d, cell.offset[2]);
  const V limit = hn::Set(d, 1 + margin);
  std::size_t n = out.count;
  auto entry = hn::Iota(du, cell.first);
  const auto step = hn::Set(du, static_cast<std::uint32_t>(lanes));
  for (std::size_t i = 0; i < cell.count; i += lanes, entry = hn::Add(entry, step)) {
    const V x = hn::MulAdd(hn::LoadU(d, cell.x + i), scale, ox);
    const V y = hn::MulAdd(hn::LoadU(d, cell.y + i), scale, oy);
    const V z = hn::MulAdd(hn::LoadU(d, cell.z + i), scale, oz);
    const V dx = hn::Max(hn::Sub(hn::Abs(x), reach), zero);
    const V dy = hn::Max(hn::Sub(hn::Abs(y), reach), zero);
    const V dz = hn::Max(hn::Sub(hn::Abs(z), reach), zero);
    auto near = hn::Lt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), limit);
    if (i + lanes > cell.count) near = hn::And(near, hn::FirstN(d, cell.count - i));
    if (hn::AllFalse(d, near)) continue;
    store_some(x, near, d, out.x.data() + n);
    store_some(y, near, d, out.y.data() + n);
    store_some(z, near, d, out.z.data() + n);
    n += store_some(entry, hn::RebindMask(du, near), du, out.entry.data() + n);
  }
  out.count = n;
}

// A box of voxel centres, and the squared distance from it within which a candidate may reach them.
BoxTest test_of(const VoxelBox& box, float h, float limit) {
  const float half = 0.5F * h * static_cast<float>(box.edge - 1);
  const auto middle = [&](int first) { return h * (static_cast<float>(first) - 3.5F) + half; };
  return {{middle(box.x), middle(box.y), middle(box.z)}, {half, half, half}, limit};
}

void PickNear(const LeafCandidates& from, const VoxelBox& box, float h, Picked& out) {
  const BoxTest test = test_of(box, h, 1 + margin);
  float* const x = out.x.room(from.count);
  float* const y = out.y.room(from.count);
  float* const z = out.z.room(from.count);
  std::int32_t* const at = out.at.room(from.count);
  std::size_t n = 0;
  auto place = hn::Iota(di, 0);
  for (std::size_t i = 0; i < from.count; i += lanes, place = hn::Add(place, hn::Set(di, lanes))) {
    const Voxels v{hn::Load(d, from.x.data() + i), hn::Load(d, from.y.data() + i), hn::Load(d, from.z.data() + i)};
    const auto near = near_box(v, test, from.count - i);
    store_some(v.x, near, d, x + n);
    store_some(v.y, near, d, y + n);
    store_some(v.z, near, d, z + n);
    n += store_some(place, hn::RebindMask(di, near), di, at + n);
  }
  out.count = n;
}

/// Narrows `least`, the squared distances of a brick's voxels from the nearest candidate, by those from `begin` on and
/// then from the start of the list, until all voxels are certainly inside or `most` have been looked at.
V NearestTo(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, const float* HWY_RESTRICT z, std::size_t count,
            std::size_t begin, std::size_t most, const Voxels& at) {
  const V sure = hn::Set(d, 1 - margin);
  V least = hn::Set(d, 4.0F);
  std::size_t i = begin;
  for (std::size_t k = 0; k < most; ++k, i = i + 1 == count ? 0 : i + 1) {
    const V dx = hn::Sub(at.x, hn::Set(d, x[i])), dy = hn::Sub(at.y, hn::Set(d, y[i])),
            dz = hn::Sub(at.z, hn::Set(d, z[i]));
    least = hn::Min(least, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
    if (k % 4 == 3 && hn::AllTrue(d, hn::Lt(least, sure))) break;
  }
  return least;
}

/// All lanes of a brick as bits.
constexpr std::uint32_t whole_brick = (1U << lanes) - 1U;

/// Calls f for the bricks of a box that are not inside altogether.
template <class F>
HWY_INLINE void for_each_open_brick(const VoxelBox& box, const LeafMask& inside, const F& f) {
  for_each_brick(box, [&](const VoxelBox& brick) HWY_ATTR {
    if (brick_bits(inside, brick) != whole_brick) f(brick);
  });
}

/// The candidates in the middle of the list lie in the leaf's own cell or near it: they cover most bricks of a leaf
/// that is full of particles.
void CoverSome(const LeafCandidates& all, float h, LeafMask& inside) {
  constexpr std::size_t enough = 48;
  const V sure = hn::Set(d, 1 - margin);
  for_each_open_brick({0, 0, 0, 8}, inside, [&](const VoxelBox& brick) HWY_ATTR {
    const V least = NearestTo(all.x.data(), all.y.data(), all.z.data(), all.count, all.count / 2,
                              all.count < enough ? all.count : enough, brick_voxels(brick, h));
    set_brick_bits(inside, brick, bits_of(d, hn::Lt(least, sure)));
  });
}

void Cover(const LeafCandidates& all, float h, NearBlocks& blocks, LeafMask& inside, LeafMask& perhaps) {
  const V sure = hn::Set(d, 1 - margin), possible = hn::Set(d, 1 + margin);
  pick_blocks(all, h, blocks);
  for (int b = 0; b < leaf_blocks; ++b) {
    const Picked& near = blocks[static_cast<std::size_t>(b)];
    for_each_open_brick(block_box(b), inside, [&](const VoxelBox& brick) HWY_ATTR {
      const V least = NearestTo(near.x.data(), near.y.data(), near.z.data(), near.count, near.count / 2, near.count,
                                brick_voxels(brick, h));
      set_brick_bits(inside, brick, bits_of(d, hn::Lt(least, sure)));
      set_brick_bits(perhaps, brick, bits_of(d, hn::Lt(least, possible)));
    });
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(ScanCell);
HWY_EXPORT(PickNear);
HWY_EXPORT(CoverSome);
HWY_EXPORT(Cover);

namespace {

// Whether an eighth of a cell may hold a point within `cutoff` (in voxels) of the box of a leaf's voxel centres.
bool in_reach(const Coord& cell, std::size_t eighth, const Coord& leaf, double cutoff) {
  double apart2 = 0;
  for (int a = 0; a < 3; ++a) {
    const double low = cell[a] - leaf[a] + (((eighth >> (2 - a)) & 1U) != 0 ? 3.5 : -0.5);
    const double apart = std::max({0.0, low - (leaf_edge - 1), -(low + 4)});
    apart2 += apart * apart;
  }
  return apart2 <= cutoff * cutoff * (1 + 1e-5);  // more than the margin of single precision
}

// Calls f(first, end) for the runs of a cell's entries whose eighths may be in reach of a leaf.
template <class F>
void for_each_run(const Buckets& buckets, std::size_t cell, const Coord& leaf, double cutoff, const F& f) {
  constexpr std::size_t few = 128;  // of so few entries it takes longer to leave some out
  const std::size_t* const eighth = buckets.eighth.data() + 8 * cell;
  if (eighth[8] - eighth[0] < few) return f(eighth[0], eighth[8]);
  for (std::size_t n = 0; n < 8; ++n) {
    const std::size_t first = n;
    while (n < 8 && in_reach(buckets.cells[cell], n, leaf, cutoff)) ++n;
    if (eighth[first] < eighth[n]) f(eighth[first], eighth[n]);
  }
}

// Scans the cells listed in `out`; those without candidates are dropped.
void scan_cells(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out) {
  std::size_t most = 0;
  for (const CellRange& range : out.cells) most += buckets.start[range.cell + 1] - buckets.start[range.cell];
  out.count = 0;
  out.x.room(most);
  out.y.room(most);
  out.z.room(most);
  out.entry.room(most);
  const auto half = static_cast<float>(3.5 / cutoff);
  const auto& [x, y, z] = buckets.local;
  for (CellRange& range : out.cells) {
    const auto from_leaf = [&](int a) { return static_cast<float>((buckets.cells[range.cell][a] - leaf[a]) / cutoff); };
    range.begin = out.count;
    for_each_run(buckets, range.cell, leaf, cutoff, [&](std::size_t first, std::size_t end) {
      const CellScan scan{x.data() + first,
                          y.data() + first,
                          z.data() + first,
                          end - first,
                          static_cast<std::uint32_t>(first),
                          static_cast<float>(1 / cutoff),
                          {from_leaf(0), from_leaf(1), from_leaf(2)}};
      HWY_DYNAMIC_DISPATCH(ScanCell)(scan, half, out);
    });
    range.end = out.count;
  }
  std::erase_if(out.cells, [](const CellRange& range) { return range.begin == range.end; });
}

}  // namespace

void gather_candidates(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out) {
  out.cells.clear();
  for_each_cell(buckets, leaf, cutoff, [&](std::size_t cell) { out.cells.push_back({cell, 0, 0}); });
  scan_cells(buckets, leaf, cutoff, out);
}

void gather_own(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out) {
  out.cells.clear();
  const auto it = std::lower_bound(buckets.cells.begin(), buckets.cells.end(), leaf);
  if (it != buckets.cells.end() && *it == leaf)
    out.cells.push_back({static_cast<std::size_t>(it - buckets.cells.begin()), 0, 0});
  scan_cells(buckets, leaf, cutoff, out);
}

void cover_some(const LeafCandidates& candidates, float voxel, LeafMask& inside) {
  HWY_DYNAMIC_DISPATCH(CoverSome)(candidates, voxel, inside);
}

void cover(const LeafCandidates& candidates, float voxel, NearBlocks& scratch, LeafMask& inside, LeafMask& perhaps) {
  HWY_DYNAMIC_DISPATCH(Cover)(candidates, voxel, scratch, inside, perhaps);
}

void pick_near(const LeafCandidates& candidates, const VoxelBox& box, float voxel, Picked& out) {
  HWY_DYNAMIC_DISPATCH(PickNear)(candidates, box, voxel, out);
}

}  // namespace grainvdb
#endif
