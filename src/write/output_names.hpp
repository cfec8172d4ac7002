#pragma once
/// Names inside the output that the data file and its sidecar share.
#include <array>
#include <string>
#include <string_view>

#include "grainvdb/field_sink.hpp"
#include "write/chunk_grid.hpp"

namespace grainvdb {

inline constexpr std::string_view mask_name = "mask";
inline constexpr std::string_view point_data_group = "/VTKHDF/PointData";

/// The path of a field's dataset.
inline std::string dataset_path(std::string_view field) {
  return std::string(point_data_group) + '/' + std::string(field);
}

/// Whether the datasets have a leading time axis.
inline bool has_time_axis(const OutputLayout& layout) {
  return layout.time_count > 1;
}

/// VTK's reader of VTKHDF images drops the axes y and z where they are one voxel long and then misreads a dataset that
/// keeps them (ParaView 5.11 crashes). Such a result is offered to ParaView through the sidecar alone.
inline bool fits_vtkhdf(const Extent3& voxels) {
  return voxels[1] > 1 && voxels[2] > 1;
}

}  // namespace grainvdb
