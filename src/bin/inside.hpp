#pragma once
/// What walls leave of a frame.
#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

/// Leaves out what has its centre behind a wall. Of half branches, those of contacts that keep both come first, so that
/// these stay together.
void keep_inside(const WallDomain& domain, Particles& particles);
void keep_inside(const WallDomain& domain, HalfBranches& branches);

}  // namespace grainvdb
