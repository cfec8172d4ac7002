#pragma once
/// The box of voxels that a run writes.
#include <optional>
#include <span>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/region.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

/// The pipeline's region, if it has one. Throws ConfigError when it holds no voxel centre.
std::optional<Region> region_of(const Pipeline& pipeline, const Lattice& lattice);

/// The voxels that the kernels can reach from the boxes of the wanted frames, within the pipeline's region: fixed for
/// all output times of a series. Throws ConfigError when there are none.
Topology::Bounds box_of_series(const Pipeline& pipeline, const Lattice& lattice, const FrameSource& source,
                               std::span<const std::size_t> wanted);

/// Where the voxels of the only output time lie. Throws ConfigError when there are none.
Topology::Bounds box_of_voxels(const Pipeline& pipeline, const Topology& topology);

/// Throws LimitError when there are more than limits.dense_voxels.
void check_dense_size(const Topology::Bounds& bounds, const Pipeline& pipeline);

}  // namespace grainvdb
