#include "base/parallel.hpp"

#include "grainvdb/stage.hpp"

namespace grainvdb {

void for_each_leaf(const Topology& topology, const std::function<void(std::size_t)>& f) {
  parallel_for(topology.leaf_count(), f);
}

}  // namespace grainvdb
