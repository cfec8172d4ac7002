#pragma once
/// Fields and masks as OpenVDB grids that are ready to be written.
#include <openvdb/openvdb.h>

#include "grainvdb/lattice.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// The grids of a field: one FloatGrid, one Vec3SGrid, or nine FloatGrids with the suffixes _xx … _zz. FloatGrids share
/// their trees with the field. `metadata` is added to each, with unit, description and equation.
openvdb::GridCPtrVec make_grids(const SparseField& field, const openvdb::MetaMap& metadata);

/// Gives the inactive voxels of the leaves the background, should they hold anything else.
void clear_inactive(openvdb::GridBase& grid);

/// The mask as an Int32Grid; inactive voxels have the flag `outside`.
openvdb::GridBase::ConstPtr make_mask_grid(const Mask& mask, const Lattice& lattice, const openvdb::MetaMap& metadata);

}  // namespace grainvdb
