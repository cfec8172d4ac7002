#pragma once
/// The measurements that tell the parameters of the spot model. docs/spot_calibration.md tells what they mean.
#include "grainvdb/measurement.hpp"

namespace grainvdb {

MeasurementInfo outflow_measurement();
MeasurementInfo density_drop_measurement();
MeasurementInfo spot_calibration_measurement();

}  // namespace grainvdb
