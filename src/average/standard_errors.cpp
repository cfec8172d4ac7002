#include <stdexcept>
#include <utility>

#include "average/register.hpp"

namespace grainvdb {

Stage standard_error_of(const Stage& field) {
  Stage s;
  s.name = field.name + "_error";
  s.components = field.components;
  s.dimension = field.dimension;
  s.description = "standard error of " + field.name + ", from blocks of frames (average.blocks)";
  s.equation =
      "sqrt((B-1)/B sum_j (f_j - mean f_j)^2), f_j without block j of B; weighted where blocks differ in length";
  s.needs = [name = field.name](const StageSettings&) { return StageNeeds{{name}, {}}; };
  s.error_of = field.name;
  return s;
}

void register_standard_errors(StageRegistry& registry) {
  for (const char* name :
       {"phi", "density", "velocity", "mean_diameter", "temperature", "contact_stress", "kinetic_stress", "stress",
        "shear_rate", "pressure", "shear_stress", "mu", "inertial_number", "fluidity", "gd_over_dv"}) {
    const Stage* field = registry.find(name);
    if (field == nullptr) throw std::logic_error(std::string("no field to take the error of: ") + name);
    registry.add(standard_error_of(*field));
  }
}

}  // namespace grainvdb
