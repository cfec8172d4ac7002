#pragma once
/// How many threads the library may use: one, but in whole runs.
#include <cstddef>

namespace grainvdb::bench {

/// Holds until the next call.
void use_threads(std::size_t count);

}  // namespace grainvdb::bench
