#pragma once
/// Time and memory of the particle splat as frames grow.
#include "sizes.hpp"

namespace grainvdb::bench {

/// growth/PARTICLES: particles to grids at h = d/2.
void register_growth(const Sizes& sizes);

/// memory/h=…: what the splat adds to the peak of the memory in use. Each is meant for a process of its own.
void register_memory(const Sizes& sizes);

}  // namespace grainvdb::bench
