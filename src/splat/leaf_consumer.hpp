#pragma once
/// How a splat hands over its sums: leaf by leaf, while they are in the cache, with no buffer for all of them.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include "grainvdb/leaf_buffers.hpp"

namespace grainvdb {

/// Takes the sums of one leaf, laid out [channel][offset], 0 where inactive; called once per leaf of the topology, for
/// different leaves at the same time.
using LeafConsumer = std::function<void(std::size_t leaf, const double* values)>;

/// All sums in buffers. `sums(topology, consume)` hands them over.
template <class Sums>
LeafBuffers kept_in_buffers(std::shared_ptr<const Topology> topology, int channels, const Sums& sums) {
  LeafBuffers result(std::move(topology), channels);
  const auto size = static_cast<std::size_t>(channels) * leaf_size;
  sums(*result.topology(),
       [&](std::size_t leaf, const double* values) { std::copy_n(values, size, result.block(leaf, 0)); });
  return result;
}

}  // namespace grainvdb
