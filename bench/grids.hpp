#pragma once
/// What both sides of a comparison make: one FloatGrid per channel, whose voxels have their centres at
/// (i+½, j+½, k+½) h.
#include <vector>

#include <openvdb/openvdb.h>

namespace grainvdb::bench {

using Grids = std::vector<openvdb::FloatGrid::Ptr>;

/// Of grids in whose index space voxels are (i, j, k).
inline openvdb::math::Transform::Ptr plain_transform(double h) {
  auto transform = openvdb::math::Transform::createLinearTransform(h);
  transform->postTranslate({h / 2, h / 2, h / 2});
  return transform;
}

}  // namespace grainvdb::bench
