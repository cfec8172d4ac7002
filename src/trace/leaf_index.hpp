#pragma once
/// Finds the leaf that holds a voxel in constant time.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

/// A hash table from origins to leaves, at most half full: 8 to 16 bytes per leaf beside a copy of the origins.
class LeafIndex {
 public:
  LeafIndex() : LeafIndex(Topology()) {}
  explicit LeafIndex(const Topology& topology);

  /// The number of the leaf with this origin; leaf_count() when there is none.
  std::size_t find(const Coord& origin) const {
    for (std::size_t slot = hash(origin);; slot = (slot + 1) & last_slot_) {
      const std::uint32_t leaf = slots_[slot];
      if (leaf == origins_.size() || origins_[leaf] == origin) return leaf;
    }
  }
  std::size_t leaf_count() const { return origins_.size(); }
  std::size_t bytes() const { return origins_.size() * sizeof(Coord) + slots_.size() * sizeof(std::uint32_t); }

 private:
  /// The slot where the search begins. Origins are multiples of 8.
  std::size_t hash(const Coord& origin) const {
    const auto part = [](std::int32_t i) { return std::uint64_t{static_cast<std::uint32_t>(i)} >> 3U; };
    std::uint64_t bits = (part(origin.x) * 0x9e3779b97f4a7c15U) ^ (part(origin.y) * 0xc2b2ae3d27d4eb4fU) ^
                         (part(origin.z) * 0x165667b19e3779f9U);
    bits ^= bits >> 32U;
    return bits & last_slot_;
  }

  std::vector<Coord> origins_;
  std::vector<std::uint32_t> slots_;  ///< the number of a leaf, or of leaves where empty
  std::size_t last_slot_;
};

}  // namespace grainvdb
