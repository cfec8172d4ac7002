#pragma once
/// The box of voxels that a run writes.
#include <span>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

/// The voxels that the kernels can reach from the boxes of the wanted frames: fixed for all output times of a series.
Topology::Bounds reach_of_boxes(const Lattice& lattice, const FrameSource& source, std::span<const std::size_t> wanted,
                                double cutoff);

/// Throws LimitError when there are more than limits.dense_voxels.
void check_dense_size(const Topology::Bounds& bounds, const Pipeline& pipeline);

}  // namespace grainvdb
