#pragma once
/// Quick bounds of how many leaves a splat will need, for refusing what cannot fit before it is begun.
#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

/// Leaves' worth of voxels that kernels of the given cutoff [length] about the points certainly reach: a cube of edge
/// cutoff/√3 that holds a point lies within its support. Cubes are counted once.
double least_leaves(const Lattice& lattice, const Columns3& position, double cutoff);

/// No more leaves than this hold a voxel within `reach` [length] of the points: what surrounds each of them, or the box
/// about all of them.
double most_leaves(const Lattice& lattice, const Columns3& position, double reach);

}  // namespace grainvdb
