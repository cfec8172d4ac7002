#pragma once
/// Fields that are ratios or invariants: over planes and shells they are formed from averages of what adds, not
/// averaged themselves (physics section 1).
#include <string>
#include <vector>

#include "grainvdb/units.hpp"
#include "measure/flow_state.hpp"

namespace grainvdb {

struct DerivedQuantity {
  std::string name;  ///< of the field
  Dimension dimension;
  std::string description;
  std::vector<std::string> fields;  ///< that it is formed from
  double (FlowState::*value)() const;
};

/// shear_rate, pressure, shear_stress, mu, inertial_number, fluidity, gd_over_dv, g_over_domega and dv_over_d_domega.
const std::vector<DerivedQuantity>& derived_quantities();
/// nullptr where the field is none of them.
const DerivedQuantity* find_derived_quantity(const std::string& name);

}  // namespace grainvdb
