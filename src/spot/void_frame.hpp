#pragma once
/// Snapshots of the void model.
#include "spot/snapshot.hpp"
#include "spot/void_model.hpp"

namespace grainvdb::spot {

/// The grains in ascending order of id. Velocities are displacements since the frame before, matched by id, divided by
/// the time between; 0 in the first one, which follows an empty one.
DumpFrame make_frame(const LatticeVoids& model, const Box& box, double diameter, const DumpFrame& before);

}  // namespace grainvdb::spot
