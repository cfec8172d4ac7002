#pragma once
/// Look-ups of leaves that mostly ask for the one they asked for before.
#include <cstddef>
#include <optional>

#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Finds leaves, remembering the last one.
class LeafFinder {
 public:
  explicit LeafFinder(const Topology& topology) : topology_(topology) {}

  /// The leaf of that origin; nothing outside the topology.
  std::optional<std::size_t> leaf(const Coord& origin) {
    if (!known_ || origin != origin_) {
      leaf_ = topology_.find(origin);
      origin_ = origin;
      known_ = true;
    }
    return leaf_;
  }

 private:
  const Topology& topology_;
  bool known_ = false;
  Coord origin_;
  std::optional<std::size_t> leaf_;
};

}  // namespace grainvdb
