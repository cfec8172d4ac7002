#pragma once
/// The contact stress against the exact scatter.
#include "sizes.hpp"

namespace grainvdb::bench {

void register_contacts(const Sizes& sizes);

/// Checks all comparisons on the scene of this size.
void check_contacts(const Sizes& sizes);

}  // namespace grainvdb::bench
