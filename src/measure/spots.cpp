#include "measure/spots.hpp"

#include "measure/register.hpp"

namespace grainvdb {

std::vector<MeasurementInfo> spot_measurements() {
  return {outflow_measurement(), density_drop_measurement(), spot_calibration_measurement()};
}

}  // namespace grainvdb
