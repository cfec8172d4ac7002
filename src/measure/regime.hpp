#pragma once
/// What Bagnold's scaling and the kinetic theory say of a state.
#include "grainvdb/laws.hpp"
#include "measure/flow_state.hpp"

namespace grainvdb {

/// P/(ρ_p d² γ̇²), which depends on φ alone where Bagnold's scaling holds; 1/I². NaN without shearing.
double bagnold_pressure(const FlowState& state);
/// p* = P d/k_n of grains of stiffness k_n [mass/time²].
double soft_pressure(const FlowState& state, double stiffness);
/// γ̇ √(ρ_p d³/k_n).
double soft_rate(const FlowState& state, double stiffness);

/// What the kinetic theory predicts; NaN where φ is outside (0, most]: it is valid up to 0.5 or so.
struct KineticPrediction {
  double steady_pressure;  ///< p/(ρ_p d² γ̇²) where shear heats as much as collisions cool
  double pressure;         ///< p/(ρ_p d² γ̇²) = f₁ T_kin/(d² γ̇²) at the measured T_kin = T/3
  double mu;               ///< τ/p = f₂ d γ̇/(f₁ √T_kin) at the measured T
};
KineticPrediction kinetic_prediction(const FlowState& state, double restitution, double most);

}  // namespace grainvdb
