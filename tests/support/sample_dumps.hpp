#pragma once
/// The dumps that come with the repository.
#include <string>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"

namespace grainvdb::testing {

/// Path of a file of the repository.
std::string in_repository(const std::string& path);

/// The shear cell: all five snapshots with their contacts. `folder` holds the dumps, by default
/// sample_dumps/shear_cell.
InputSpec shear_cell_input(const std::string& folder = in_repository("sample_dumps/shear_cell"));

/// All its particles and contacts on voxels of 0.4 mm from the origin, c = 2.4 mm.
Pipeline shear_cell_pipeline(std::vector<std::string> fields);

}  // namespace grainvdb::testing
