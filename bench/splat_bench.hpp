#pragma once
/// The particle splat against its baselines, its kernel loop against the machine, and its channel counts.
#include "sizes.hpp"

namespace grainvdb::bench {

void register_splat(const Sizes& sizes);

/// Checks all comparisons on the scene of this size.
void check_splat(const Sizes& sizes);

}  // namespace grainvdb::bench
