#pragma once
/// Baseline: the splat as everyone writes it first. Each particle visits the voxels of its support, evaluates the
/// kernel once per voxel and adds its channels to FloatGrids through value accessors, one getValue and one setValue per
/// channel. The kernel is evaluated in double precision, the sums grow in the grids, in single precision.
#include <span>

#include "grids.hpp"
#include "scene.hpp"

namespace grainvdb::bench {

/// `q` is laid out [particle][channel].
Grids naive_splat(const Scene& scene, double h, std::span<const double> q, int channels);

}  // namespace grainvdb::bench
