#pragma once
/// The measurements of plasticity and of the kinematic theory, one a file.
#include <string>

#include "grainvdb/measurement.hpp"

namespace grainvdb {

MeasurementInfo incipient_yield_measurement();
MeasurementInfo coaxiality_measurement();
MeasurementInfo stochastic_flow_rule_measurement();
MeasurementInfo box_strain_rate_measurement();
MeasurementInfo collapse_measurement();
MeasurementInfo kinematic_fit_measurement();
MeasurementInfo mean_field_measurement();

/// `phi_min`: the packing fraction below which voxels count as no material.
OptionInfo least_phi_option();
/// `bins` of a histogram.
OptionInfo bins_option(std::int64_t bins);

}  // namespace grainvdb
