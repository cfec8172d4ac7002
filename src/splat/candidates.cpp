#include "splat/candidates.hpp"

#include <algorithm>

#include "splat/gather.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/candidates.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

#ifndef GRAINVDB_SPLAT_CELL_SCAN
#define GRAINVDB_SPLAT_CELL_SCAN
namespace grainvdb {

// A cell's entries, and how their positions become those of candidates: x = local · scale + offset.
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

// Squared distances carry the rounding of three positions (2e-7 each, in units of the cutoff) and of their squares.
constexpr float margin = 4e-6F;

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
    hn::CompressStore(x, near, d, out.x.data() + n);
    hn::CompressStore(y, near, d, out.y.data() + n);
    hn::CompressStore(z, near, d, out.z.data() + n);
    n += hn::CompressStore(entry, hn::RebindMask(du, near), du, out.entry.data() + n);
  }
  out.count = n;
}

void PickNear(const float* x, const float* y, const float* z, std::size_t count, const VoxelBox& box, float h,
              Picked& out) {
  std::int32_t* at = out.at.room(count);
  const float extent = h * static_cast<float>(box.edge - 1);
  const float lo[3] = {h * (static_cast<float>(box.x) - 3.5F), h * (static_cast<float>(box.y) - 3.5F),
                       h * (static_cast<float>(box.z) - 3.5F)};
  const float extents[3] = {extent, extent, extent};
  out.count = pick(x, y, z, count, lo, extents, 1 + margin, at);
  float* px = out.x.room(out.count);
  float* py = out.y.room(out.count);
  float* pz = out.z.room(out.count);
  for (std::size_t k = 0; k < out.count; ++k) {
    px[k] = x[at[k]];
    py[k] = y[at[k]];
    pz[k] = z[at[k]];
  }
}

/// Adds the lanes of a brick to a leaf's mask.
void add_bits(hn::Mask<D> lanes_set, const VoxelBox& brick, LeafMask& mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, lanes_set, bytes);
  const unsigned bits = bytes[0] | static_cast<unsigned>(bytes[1]) << 8U;
  for (int i = 0; i < brick_x; ++i)
    for (int j = 0; j < brick_y; ++j) {
      const std::uint64_t row = bits >> ((i * brick_y + j) * brick_z) & ((1U << brick_z) - 1U);
      mask.words[static_cast<std::size_t>(brick.x + i)] |= row << ((brick.y + j) * 8 + brick.z);
    }
}

/// One brick. The voxels near the middle of the list's cells are covered first when the search starts there.
void CoverBrick(const Picked& near, const VoxelBox& brick, float h, LeafMask& inside, LeafMask& perhaps) {
  const Voxels at = brick_voxels(brick, h);
  const V sure = hn::Set(d, 1 - margin), possible = hn::Set(d, 1 + margin);
  V least = hn::Set(d, 4.0F);
  std::size_t i = near.count / 2;
  for (std::size_t k = 0; k < near.count; ++k, i = i + 1 == near.count ? 0 : i + 1) {
    const V dx = hn::Sub(at.x, hn::Set(d, near.x[i])), dy = hn::Sub(at.y, hn::Set(d, near.y[i])),
            dz = hn::Sub(at.z, hn::Set(d, near.z[i]));
    least = hn::Min(least, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
    if (hn::AllTrue(d, hn::Lt(least, sure))) break;
  }
  add_bits(hn::Lt(least, sure), brick, inside);
  add_bits(hn::Lt(least, possible), brick, perhaps);
}

void Cover(const LeafCandidates& candidates, float h, Picked& near, LeafMask& inside, LeafMask& perhaps) {
  for (int bx = 0; bx < 8; bx += block)
    for (int by = 0; by < 8; by += block)
      for (int bz = 0; bz < 8; bz += block) {
        PickNear(candidates.x.data(), candidates.y.data(), candidates.z.data(), candidates.count, {bx, by, bz, block},
                 h, near);
        for (int x = bx; x < bx + block; x += brick_x)
          for (int y = by; y < by + block; y += brick_y)
            for (int z = bz; z < bz + block; z += brick_z) CoverBrick(near, {x, y, z}, h, inside, perhaps);
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
HWY_EXPORT(Cover);

void gather_candidates(const Buckets& buckets, const Coord& leaf, double cutoff, LeafCandidates& out) {
  out.count = 0;
  out.cells.clear();
  std::size_t most = 0;
  for_each_cell(buckets, leaf, cutoff, [&](std::size_t cell) {
    out.cells.push_back({cell, 0, 0});
    most += buckets.start[cell + 1] - buckets.start[cell];
  });
  out.x.room(most);
  out.y.room(most);
  out.z.room(most);
  out.entry.room(most);
  const auto half = static_cast<float>(3.5 / cutoff);
  for (CellRange& range : out.cells) {
    const std::size_t first = buckets.start[range.cell];
    const Coord& origin = buckets.cells[range.cell];
    CellScan scan{buckets.local[0].data() + first,
                  buckets.local[1].data() + first,
                  buckets.local[2].data() + first,
                  buckets.start[range.cell + 1] - first,
                  static_cast<std::uint32_t>(first),
                  static_cast<float>(1 / cutoff),
                  {}};
    for (int a = 0; a < 3; ++a) scan.offset[a] = static_cast<float>((origin[a] - leaf[a]) / cutoff);
    range.begin = out.count;
    HWY_DYNAMIC_DISPATCH(ScanCell)(scan, half, out);
    range.end = out.count;
  }
  std::erase_if(out.cells, [](const CellRange& range) { return range.begin == range.end; });
}

void cover(const LeafCandidates& candidates, float voxel, Picked& scratch, LeafMask& inside, LeafMask& perhaps) {
  HWY_DYNAMIC_DISPATCH(Cover)(candidates, voxel, scratch, inside, perhaps);
}

void pick_near(const float* x, const float* y, const float* z, std::size_t count, const VoxelBox& box, float voxel,
               Picked& out) {
  HWY_DYNAMIC_DISPATCH(PickNear)(x, y, z, count, box, voxel, out);
}
}  // namespace grainvdb
#endif
