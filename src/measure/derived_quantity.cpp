#include "measure/derived_quantity.hpp"

#include <algorithm>

namespace grainvdb {

const std::vector<DerivedQuantity>& derived_quantities() {
  static const std::vector<DerivedQuantity> all{
      {"shear_rate",
       dimension::rate,
       "|gd| of the mean velocity gradient (A8)",
       {"velocity_gradient"},
       &FlowState::shear_rate},
      {"pressure", dimension::stress, "P of the mean stress (A11)", {"stress"}, &FlowState::pressure},
      {"shear_stress", dimension::stress, "|sigma| of the mean stress (A12)", {"stress"}, &FlowState::shear_stress},
      {"mu", dimension::none, "|sigma|/P of the mean stress", {"stress", "pressure_floor"}, &FlowState::mu},
      {"inertial_number",
       dimension::none,
       "I = |gd| d sqrt(rho_p/P) of the means",
       {"velocity_gradient", "stress", "pressure_floor", "mean_diameter", "density", "phi"},
       &FlowState::inertial_number},
      {"fluidity",
       dimension::rate,
       "g = |gd|/mu of the means (1)",
       {"velocity_gradient", "stress", "pressure_floor"},
       &FlowState::fluidity},
      {"gd_over_dv",
       dimension::none,
       "g d/dv of the means (2)",
       {"velocity_gradient", "stress", "pressure_floor", "mean_diameter", "temperature", "phi"},
       &FlowState::gd_over_dv},
      {"g_over_domega",
       dimension::none,
       "g/domega of the means (A24)",
       {"velocity_gradient", "stress", "pressure_floor", "rotational_fluctuation", "phi"},
       &FlowState::g_over_domega},
      {"dv_over_d_domega",
       dimension::none,
       "dv/(d domega) of the means (A25)",
       {"mean_diameter", "temperature", "rotational_fluctuation", "phi"},
       &FlowState::dv_over_d_domega}};
  return all;
}

const DerivedQuantity* find_derived_quantity(const std::string& name) {
  const auto& all = derived_quantities();
  const auto it = std::find_if(all.begin(), all.end(), [&](const DerivedQuantity& q) { return q.name == name; });
  return it == all.end() ? nullptr : &*it;
}

}  // namespace grainvdb
