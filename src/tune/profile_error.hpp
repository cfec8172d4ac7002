#pragma once
/// Averages over planes: those of the voxels (measure.profile) and the exact ones (measure.plane_profile).
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/table.hpp"
#include "grainvdb/tune.hpp"

namespace grainvdb {

/// What both measurements have of what the pipeline measures by either: "profile.phi", "profile.velocity", … Nothing
/// where it measures neither, or by shells, wide bins or some of the points; and in boxes whose planes have no known
/// area.
std::vector<std::string> profile_quantities(const Pipeline& pipeline, const FrameSource& source);

/// The other measurement in place of the one that the pipeline has; nothing where it has both.
std::optional<Knob> profile_knob(const Pipeline& pipeline);

/// The pipeline that measures nothing but the exact averages, at its planes.
Pipeline exact_profile(Pipeline pipeline);

/// Throws ConfigError where both measure profiles, but along different axes: those are not to be compared.
void require_same_axis(const Pipeline& a, const Pipeline& b);

/// The errors of these quantities, those of the tables of a run, at the planes of the exact ones. Means over grains are
/// weighted with phi.
std::vector<FieldError> profile_errors(const std::vector<std::string>& quantities, const std::vector<Table>& exact,
                                       const std::vector<Table>& found);

}  // namespace grainvdb
