#pragma once
/// Events of the spot model.
#include "sizes.hpp"

namespace grainvdb::bench {

/// spot/relaxed/… and spot/unrelaxed/…: events in a draining silo that spots have filled, by the library, by a plain
/// program with cells, and by one without.
void register_spots(const Sizes& sizes);

/// Checks that the library and the plain program make the same run.
void check_spots(const Sizes& sizes);

}  // namespace grainvdb::bench
