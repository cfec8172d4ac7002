#include "trace/leaf_index.hpp"

#include <bit>

namespace grainvdb {

LeafIndex::LeafIndex(const Topology& topology)
    : origins_(topology.origins()),
      slots_(std::bit_ceil(2 * origins_.size() + 1), static_cast<std::uint32_t>(origins_.size())),
      last_slot_(slots_.size() - 1) {
  for (std::size_t leaf = 0; leaf < origins_.size(); ++leaf) {
    std::size_t slot = hash(origins_[leaf]);
    while (slots_[slot] != origins_.size()) slot = (slot + 1) & last_slot_;
    slots_[slot] = static_cast<std::uint32_t>(leaf);
  }
}

}  // namespace grainvdb
