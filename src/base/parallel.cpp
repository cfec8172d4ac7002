#include <tbb/parallel_for.h>

#include "grainvdb/stage.hpp"

namespace grainvdb {

void for_each_leaf(const Topology& topology, const std::function<void(std::size_t)>& f) {
  tbb::parallel_for(std::size_t{0}, topology.leaf_count(), [&](std::size_t leaf) { f(leaf); });
}

}  // namespace grainvdb
