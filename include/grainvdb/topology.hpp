#pragma once
/// Which voxels exist: leaves of 8³ voxels as in an OpenVDB tree, with a mask of the active voxels in each.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "grainvdb/lattice.hpp"

namespace grainvdb {

inline constexpr int leaf_edge = 8;
inline constexpr int leaf_size = leaf_edge * leaf_edge * leaf_edge;

/// Origin of the leaf that holds a voxel.
constexpr Coord leaf_origin(const Coord& c) {
  return {c.x & ~7, c.y & ~7, c.z & ~7};
}
/// Offset of a voxel in its leaf, 64 x + 8 y + z, as in OpenVDB.
constexpr int leaf_offset(const Coord& c) {
  return ((c.x & 7) << 6) | ((c.y & 7) << 3) | (c.z & 7);
}
/// The voxel at an offset of the leaf with the given origin.
constexpr Coord voxel_at(const Coord& origin, int offset) {
  return {origin.x + (offset >> 6), origin.y + ((offset >> 3) & 7), origin.z + (offset & 7)};
}

/// Active voxels of a leaf: bit (offset & 63) of word (offset >> 6).
struct LeafMask {
  std::array<std::uint64_t, 8> words{};

  bool test(int offset) const { return (words[offset >> 6] >> (offset & 63)) & 1u; }
  void set(int offset) { words[offset >> 6] |= std::uint64_t{1} << (offset & 63); }
  bool none() const;
  std::size_t count() const;
  LeafMask& operator|=(const LeafMask& o);
  bool operator==(const LeafMask&) const = default;

  /// Calls f(offset) for each active voxel, in ascending order.
  template <class F>
  void for_each(F&& f) const {
    for (int w = 0; w < 8; ++w)
      for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) f(64 * w + std::countr_zero(bits));
  }
};

/// Leaves in ascending order of origin. Immutable once built; fields that share a topology share one object.
class Topology {
 public:
  Topology() = default;
  /// Takes leaves in any order; leaves without an active voxel are dropped, equal origins are merged.
  Topology(std::vector<Coord> origins, std::vector<LeafMask> masks);

  std::size_t leaf_count() const { return origins_.size(); }
  const Coord& origin(std::size_t leaf) const { return origins_[leaf]; }
  const LeafMask& mask(std::size_t leaf) const { return masks_[leaf]; }
  const std::vector<Coord>& origins() const { return origins_; }
  std::size_t active_voxel_count() const;

  /// The index of the leaf with this origin, if there is one.
  std::optional<std::size_t> find(const Coord& origin) const;

  /// Smallest box of voxels [first, last] that holds all active voxels; nothing when there are none.
  struct Bounds {
    Coord first, last;
  };
  std::optional<Bounds> bounds() const;

 private:
  std::vector<Coord> origins_;
  std::vector<LeafMask> masks_;
};

}  // namespace grainvdb
