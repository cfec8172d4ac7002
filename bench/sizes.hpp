#pragma once
/// How much work the benchmarks do.
#include <cstddef>

namespace grainvdb::bench {

struct Sizes {
  std::size_t particles = 32000;  ///< of the comparisons
};

}  // namespace grainvdb::bench
