#pragma once
/// What both sides of a comparison make: one FloatGrid per channel, whose voxel (i, j, k) has its centre at
/// (i+½, j+½, k+½) h.
#include <vector>

#include <openvdb/openvdb.h>

namespace grainvdb::bench {

using Grids = std::vector<openvdb::FloatGrid::Ptr>;

}  // namespace grainvdb::bench
