#pragma once
/// Moments by name, and values on a few voxels.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "average/moment_sums.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"

namespace grainvdb {

inline MomentPtr moment(const std::string& name, int channels = 1) {
  Moment m;
  m.name = name;
  m.channels = channels;
  return std::make_shared<const Moment>(std::move(m));
}

inline std::shared_ptr<const Topology> topology_of(const std::vector<Coord>& voxels) {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (const Coord& c : voxels) {
    origins.push_back(leaf_origin(c));
    masks.emplace_back().set(leaf_offset(c));
  }
  return std::make_shared<Topology>(std::move(origins), std::move(masks));
}

/// Buffers on these voxels; channel k of every voxel holds values[k].
inline LeafBuffers buffers(const std::vector<Coord>& voxels, const std::vector<double>& values) {
  const auto topology = topology_of(voxels);
  LeafBuffers b(topology, static_cast<int>(values.size()));
  for (const Coord& c : voxels)
    for (std::size_t k = 0; k < values.size(); ++k)
      b.block(topology->find(leaf_origin(c)).value(), static_cast<int>(k))[leaf_offset(c)] = values[k];
  return b;
}

inline double value_at(const MomentMeans& means, const Coord& c, const Moment& m, int channel = 0) {
  return means.block(means.topology()->find(leaf_origin(c)).value(), m, channel)[leaf_offset(c)];
}
inline double frames_at(const MomentMeans& means, const Coord& c) {
  return means.frame_count(means.topology()->find(leaf_origin(c)).value())[leaf_offset(c)];
}

inline const Coord a{0, 0, 0}, b{1, 2, 3}, far_away{-17, 40, 8};

}  // namespace grainvdb
