#pragma once
/// Baseline: tracers moved one after the other, by samplers of OpenVDB.
#include <cstddef>

#include "grainvdb/frame.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb::bench {

/// `steps` classic Runge-Kutta steps of length dt: trilinear interpolation (tools::GridSampler, BoxSampler) of the
/// three grids of the velocity, each with an accessor that remembers where it was.
void move_with_vdb(const SparseField& velocity, std::size_t steps, double dt, Columns3& position);

}  // namespace grainvdb::bench
