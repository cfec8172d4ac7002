#pragma once
/// Which voxels lie around a place.
#include "grainvdb/lattice.hpp"

namespace grainvdb {

/// The cell of eight voxels around a place.
struct Cell {
  Coord voxel;  ///< the lower one, of the stored period
  Vec3 within;  ///< from its centre, in voxels
};

/// `x` must be within 2³⁰ voxels of the origin along axes without period.
Cell cell_at(const Lattice& lattice, const Vec3& x);

}  // namespace grainvdb
