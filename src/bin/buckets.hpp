#pragma once
/// Points sorted into the leaves of the lattice, periodic images included: what the splat reads.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/region.hpp"

namespace grainvdb {

/// Entries of one leaf-sized cell are contiguous: cell i holds entries start[i] … start[i+1]-1. Those of each eighth of
/// it are, too, in ascending order of their point's index, so that sums do not depend on threads or on the order of rows
/// in the dump.
struct Buckets {
  std::vector<Coord> cells;          ///< leaf origins, ascending
  std::vector<std::size_t> start;    ///< cells.size() + 1 offsets
  /// 8 cells.size() + 1 offsets: eighth n = 4 x + 2 y + z of cell i, x, y, z = 1 in the upper half along an axis, begins
  /// at eighth[8 i + n].
  std::vector<std::size_t> eighth;
  std::vector<std::uint32_t> point;  ///< index of the point that each entry is an image of
  Columns3 index;                    ///< position of each entry in index space (whole numbers are voxel centres)
  /// The same in single precision, relative to the centre of the cell (origin + 3½); followed by `padding` zeros.
  std::array<std::vector<float>, 3> local;
  static constexpr std::size_t padding = 16;  ///< so that vectors may be loaded at any entry
};

/// Wraps the points along periodic axes and adds every image that lies within `reach` [length] of the stored period.
/// Cells with no point within `reach` of the leaves that are wanted stay empty; others are complete. nullptr: all
/// leaves. Positions must be finite and their index must fit 31 bits (the executor checks extents before); throws
/// std::invalid_argument otherwise.
Buckets bin_points(const Lattice& lattice, const Columns3& position, double reach, const Region* wanted = nullptr);

/// The entries of the points with the number `wanted` alone, in their order. Points are counted among these.
Buckets keep_points(const Buckets& all, std::span<const int> number, int wanted);

}  // namespace grainvdb
