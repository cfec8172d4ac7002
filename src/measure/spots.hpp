#pragma once
/// The measurements that tell the parameters of the spot model. docs/spot_calibration.md tells what they mean.
#include <optional>

#include "grainvdb/measurement.hpp"

namespace grainvdb {

MeasurementInfo outflow_measurement();
MeasurementInfo density_drop_measurement();
MeasurementInfo spot_calibration_measurement();

/// Refuses options without a box `lo` to `hi`.
std::optional<OptionConflict> whole_box_conflict(const OptionValues& options);

}  // namespace grainvdb
