#pragma once
/// The derived fields of physics section 4, one family in a file of its own.
#include "grainvdb/stage.hpp"

namespace grainvdb {

void register_gradients(StageRegistry& registry);          ///< velocity_gradient
void register_rates(StageRegistry& registry);              ///< shear_rate
void register_stress_invariants(StageRegistry& registry);  ///< pressure, pressure_floor, shear_stress, mu
void register_rheology(StageRegistry& registry);           ///< inertial_number, regime
void register_fluidity(StageRegistry& registry);           ///< fluidity, gd_over_dv
void register_spin(StageRegistry& registry);               ///< rotational_temperature, g_over_domega, dv_over_d_domega
void register_principal(StageRegistry& registry);          ///< principal_stress, principal_axes, principal_gap
void register_mohr_coulomb(StageRegistry& registry);       ///< mu_mohr_coulomb, slip_lines
void register_coaxiality(StageRegistry& registry);         ///< coaxiality_angle
void register_spot_drift(StageRegistry& registry);         ///< mean_extreme_stress, spot_drift

}  // namespace grainvdb
