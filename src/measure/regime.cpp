#include "measure/regime.hpp"

#include <cmath>

#include "grainvdb/laws.hpp"

namespace grainvdb {

double bagnold_pressure(const FlowState& state) {
  const double speed = state.diameter * state.shear_rate();
  return speed > 0 ? state.pressure() / (state.grain_density() * speed * speed) : FlowState::unknown;
}

double soft_pressure(const FlowState& state, double stiffness) {
  return state.pressure() * state.diameter / stiffness;
}

double soft_rate(const FlowState& state, double stiffness) {
  return state.shear_rate() * std::sqrt(state.grain_density() * std::pow(state.diameter, 3) / stiffness);
}

KineticPrediction kinetic_prediction(const FlowState& state, double restitution, double most) {
  const double nu = state.phi;
  const double speed = state.diameter * state.shear_rate();
  const double t_kin = state.temperature / 3;
  if (!(nu > 0 && nu <= most)) return {FlowState::unknown, FlowState::unknown, FlowState::unknown};
  const KineticTheory theory(restitution);
  return {theory.steady_shear_pressure(nu), speed > 0 ? theory.f1(nu) * t_kin / (speed * speed) : FlowState::unknown,
          t_kin > 0 ? theory.f2(nu) * speed / (theory.f1(nu) * std::sqrt(t_kin)) : FlowState::unknown};
}

}  // namespace grainvdb
