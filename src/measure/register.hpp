#pragma once
/// The measurements that come with the library, one function a family.
#include <vector>

#include "grainvdb/measurement.hpp"

namespace grainvdb {

std::vector<MeasurementInfo> profile_measurements();
std::vector<MeasurementInfo> plane_profile_measurements();
std::vector<MeasurementInfo> fluidity_measurements();
std::vector<MeasurementInfo> rheology_measurements();
std::vector<MeasurementInfo> stationarity_measurements();
std::vector<MeasurementInfo> plasticity_measurements();
std::vector<MeasurementInfo> structure_measurements();
std::vector<MeasurementInfo> spot_measurements();

}  // namespace grainvdb
