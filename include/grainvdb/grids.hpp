#pragma once
/// The OpenVDB grids behind a SparseField. Apart from sparse_field.hpp because OpenVDB is slow to compile.
#include <vector>

#include <openvdb/openvdb.h>

#include "grainvdb/lattice.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// Where a voxel of the lattice is in the index space of a grid. The upper nodes of a tree are 4096 voxels wide, take
/// 270 kB each and meet at 0, where the corner of most domains is: away from there one of them holds what eight would
/// share.
inline openvdb::Coord grid_index(const Coord& voxel) {
  constexpr int half_a_node = 2048;
  return {voxel.x + half_a_node, voxel.y + half_a_node, voxel.z + half_a_node};
}

/// From the index space of grids on a lattice to the coordinates of the dump; whole indices are voxel centres.
openvdb::math::Transform::Ptr grid_transform(const Lattice& lattice);

/// One grid per component, named as the field; world coordinates are those of the dump, voxel values at voxel centres.
struct SparseField::Grids {
  std::vector<openvdb::FloatGrid::Ptr> components;
};

}  // namespace grainvdb
