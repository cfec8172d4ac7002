#pragma once
/// Who is near whom: for each place the places of its neighbours. Lists that are joined are mutual.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spot/push_kernel.hpp"

namespace grainvdb::spot {

class NearLists {
 public:
  /// Empty lists for so many places.
  void reset(std::size_t places);
  NearView view() const { return {members_.data(), counts_.data(), counts_.size()}; }

  /// Puts two particles into each other's list, in which they are not yet.
  void join(std::int32_t i, std::int32_t j);
  /// Makes a particle's own list, of all these but itself, and no one else's.
  void set(std::int32_t i, std::span<const std::int32_t> neighbours);
  /// Takes a particle out of all lists, and empties its own.
  void forget(std::int32_t i);
  /// Place c * before + k becomes c * after + k, for k < before ≤ after; others are new, with empty lists.
  void widen_cells(std::size_t before, std::size_t after);

 private:
  std::int32_t& member(std::int32_t i, std::int32_t k);
  void add(std::int32_t i, std::int32_t j);
  void remove(std::int32_t i, std::int32_t j);
  void add_group();

  std::vector<std::int32_t> members_, counts_;
};

}  // namespace grainvdb::spot
