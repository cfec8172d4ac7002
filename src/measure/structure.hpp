#pragma once
/// The measurements of packing structure and of how grains move among each other. docs/structure.md tells what they
/// mean.
#include "grainvdb/measurement.hpp"

namespace grainvdb {

MeasurementInfo pair_correlation_measurement();
MeasurementInfo bond_angles_measurement();
MeasurementInfo coordination_measurement();
MeasurementInfo overlap_measurement();
MeasurementInfo voronoi_measurement();
MeasurementInfo velocity_correlation_measurement();
MeasurementInfo diffusion_measurement();
MeasurementInfo surface_angle_measurement();

/// What a table says where no frame had a grain.
inline constexpr const char* no_grains = "No frame has a grain that counts.";

}  // namespace grainvdb
