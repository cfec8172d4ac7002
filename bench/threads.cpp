#include "threads.hpp"

#include <optional>

#include <tbb/global_control.h>

namespace grainvdb::bench {

void use_threads(std::size_t count) {
  static std::optional<tbb::global_control> limit;
  limit.reset();  // of several limits the smallest would count
  limit.emplace(tbb::global_control::max_allowed_parallelism, count);
}

}  // namespace grainvdb::bench
