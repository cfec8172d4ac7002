#pragma once
/// Baseline: the same sums with OpenVDB's own means, points::rasterize with a transfer scheme for the Lucy kernel.
/// The particles are converted to a PointDataGrid first, which is part of the work as sorting them is part of the
/// library's. One call of rasterize serves all channels; it visits the leaves of the result, and in each the particles
/// that reach it, so that it writes to one leaf of every grid at a time.
#include "grids.hpp"
#include "scene.hpp"

namespace grainvdb::bench {

/// All channels; active where the kernel reaches.
Grids rasterize_splat(const Scene& scene, double h);

}  // namespace grainvdb::bench
