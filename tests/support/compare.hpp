#pragma once
/// Fields that were written against what was expected, at every voxel.
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "support/memory_sink.hpp"
#include "support/uncertain.hpp"
#include "support/voxel_box.hpp"

namespace grainvdb::testing {

struct Agreement {
  std::size_t checked = 0;    ///< values with an expected number, or that must be NaN
  std::size_t in_doubt = 0;   ///< values that a threshold within the error leaves open
  std::size_t failures = 0;   ///< values beyond their bound
  double worst_relative = 0;  ///< max |error|/magnitude, of the values whose bound is within 1e-5 of the magnitude
  double worst_of_bound = 0;  ///< max |error|/bound
  std::string first_failure;
};

/// Compares every component of a field at every active voxel: |found - expected| ≤ error, NaN exactly where undefined.
Agreement compare(const FieldCopy& field, const VoxelBox& box, const std::vector<bool>& active,
                  const std::function<Uncertain(std::size_t voxel, int component)>& expected,
                  const std::function<double(std::size_t voxel, int component)>& magnitude);

/// The number of voxels in which the topology and the expected active set differ; voxels outside the stored period
/// count as different.
std::size_t topology_differences(const Topology& topology, const VoxelBox& box, const std::vector<bool>& active);

}  // namespace grainvdb::testing
