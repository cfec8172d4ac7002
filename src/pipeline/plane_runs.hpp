#pragma once
/// The exact averages over planes that measurements ask for. Those over the same planes are one pipeline of their own,
/// whose fields are on a column of voxels, and which reads what these fields need.
#include <string>
#include <vector>

#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

struct PlaneRun {
  Pipeline pipeline;
  Plan plan;
  std::vector<std::string> measurements;  ///< that take its fields
  std::vector<std::string> remarks;       ///< sentences: what the pipeline wants and exact averages do not mind
};

/// Throws ConfigError for fields whose options do not go together, and for walls that are cut off otherwise than plane
/// by plane.
std::vector<PlaneRun> plane_runs(const Pipeline& pipeline);

/// Takes the area of the planes from the box where it is not given. Throws InputError where the box is not periodic
/// along them.
void set_area(Planes& planes, const FrameInfo& first);

/// What these runs read of every frame.
ColumnSet plane_columns(const Pipeline& pipeline);

}  // namespace grainvdb
