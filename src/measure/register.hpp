#pragma once
/// The measurements that come with the library, one function a family.
#include <vector>

#include "grainvdb/measurement.hpp"

namespace grainvdb {

std::vector<MeasurementInfo> structure_measurements();

}  // namespace grainvdb
