#include "measure/plasticity.hpp"

#include "measure/register.hpp"

namespace grainvdb {

std::vector<MeasurementInfo> plasticity_measurements() {
  return {incipient_yield_measurement(), coaxiality_measurement(), stochastic_flow_rule_measurement(),
          box_strain_rate_measurement(), collapse_measurement(),   kinematic_fit_measurement(),
          mean_field_measurement()};
}

OptionInfo least_phi_option() {
  return {.name = "phi_min",
          .default_value = 0.3,
          .help = "voxels with a packing fraction below this are left out: free fall, free surfaces",
          .minimum = 0,
          .maximum = 1};
}

OptionInfo bins_option(std::int64_t bins) {
  return {.name = "bins", .default_value = bins, .help = "bins of the histogram", .minimum = 1, .maximum = 10000};
}

}  // namespace grainvdb
