#pragma once
/// How a splat hands over its sums: leaf by leaf, while they are in the cache, with no buffer for all of them.
#include <cstddef>
#include <functional>

namespace grainvdb {

/// Takes the sums of one leaf, laid out [channel][offset], 0 where inactive; called once per leaf of the topology, for
/// different leaves at the same time.
using LeafConsumer = std::function<void(std::size_t leaf, const double* values)>;

}  // namespace grainvdb
