#pragma once
/// The OpenVDB grids behind a SparseField. Apart from sparse_field.hpp because OpenVDB is slow to compile.
#include <vector>

#include <openvdb/openvdb.h>

#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// One grid per component, named as the field; world coordinates are those of the dump, voxel values at voxel centres.
struct SparseField::Grids {
  std::vector<openvdb::FloatGrid::Ptr> components;
};

}  // namespace grainvdb
