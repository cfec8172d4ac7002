#include "measure/flow_state.hpp"

#include <cmath>

namespace grainvdb {
namespace {

double ratio(double above, double below, double least = 0) {
  return below > least ? above / below : FlowState::unknown;
}

}  // namespace

double FlowState::shear_stress() const {
  return std::sqrt(deviator_square(stress) / 2);
}
double FlowState::mu() const {
  return ratio(shear_stress(), pressure(), least_pressure);
}
double FlowState::inertial_number() const {
  return shear_rate() * diameter * std::sqrt(ratio(grain_density(), pressure(), least_pressure));
}
double FlowState::fluidity() const {
  return ratio(shear_rate(), mu());
}
double FlowState::gd_over_dv() const {
  return ratio(fluidity() * diameter, std::sqrt(temperature), std::sqrt(least_temperature));
}
double FlowState::g_over_domega() const {
  return ratio(fluidity(), std::sqrt(spin_fluctuation));
}
double FlowState::dv_over_d_domega() const {
  return ratio(std::sqrt(temperature), diameter * std::sqrt(spin_fluctuation));
}

}  // namespace grainvdb
