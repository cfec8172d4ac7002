#pragma once
/// The state of the flow at a place, and the ratios that are formed of it.
#include <limits>

#include "derive/tensor.hpp"

namespace grainvdb {

/// Averages of what adds, after division by the weight of each. NaN where a part is not known.
struct FlowState {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double phi = unknown;                      ///< packing fraction [1]
  double density = unknown;                  ///< Σ m W [mass/length³]
  Vec3 velocity{unknown, unknown, unknown};  ///< u [velocity]
  double diameter = unknown;                 ///< d [length]
  double temperature = unknown;              ///< T = δv², the sum over components [velocity²]
  double spin_fluctuation = unknown;         ///< δω² [1/time²]
  Tensor gradient = filled(unknown);         ///< ∂u_i/∂x_j [1/time]
  Tensor stress = filled(unknown);           ///< tension positive [stress]

  double least_pressure = 0;     ///< ratios to pressures up to it are not formed [stress]
  double least_temperature = 0;  ///< likewise for δv² [velocity²]

  static constexpr Tensor filled(double x) { return {x, x, x, x, x, x, x, x, x}; }

  double grain_density() const { return density / phi; }
  double shear_rate() const { return shear_rate_of(gradient); }  ///< |γ̇| (A8)
  double pressure() const { return -trace(stress) / 3; }         ///< P (A11)
  double shear_stress() const;                                   ///< |σ| (A12)

  // NaN where the pressure or temperature they are divided by is not above its least, or another divisor is not
  // positive.
  double mu() const;                ///< μ = |σ|/P
  double inertial_number() const;   ///< I = |γ̇| d √(ρ_p/P)
  double fluidity() const;          ///< g = |γ̇|/μ (1)
  double gd_over_dv() const;        ///< g d/δv (2)
  double g_over_domega() const;     ///< g/δω (A24)
  double dv_over_d_domega() const;  ///< δv/(d δω) (A25)
};

/// The state with the values value(field, component) of the fields of a pipeline, NaN for those that there are not.
template <class Value>
FlowState flow_state(const Value& value) {
  FlowState s;
  s.phi = value("phi");
  s.density = value("density");
  s.diameter = value("mean_diameter");
  s.temperature = value("temperature");
  s.spin_fluctuation = value("rotational_fluctuation");
  for (int c = 0; c < 3; ++c) s.velocity[static_cast<std::size_t>(c)] = value("velocity", c);
  for (int c = 0; c < 9; ++c) {
    s.gradient[static_cast<std::size_t>(c)] = value("velocity_gradient", c);
    s.stress[static_cast<std::size_t>(c)] = value("stress", c);
  }
  const double floor = value("pressure_floor");
  if (floor > 0) s.least_pressure = floor;
  return s;
}

}  // namespace grainvdb
