#include <cmath>

#include "derive/register.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {

void register_rheology(StageRegistry& registry) {
  Stage s;
  s.name = "inertial_number";
  s.description = "inertial number, with the local density of the grains";
  s.equation = "I = |gd| d sqrt(rho_p/P), rho_p = rho/phi";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes& notes, double rate, double p, double floor, double d, double density, double phi) {
          if (!(phi > 0)) return notes.undefined(Reason::no_material);
          if (!(p > floor)) return notes.undefined(Reason::low_pressure);
          return rate * d * std::sqrt(density / phi / p);
        };
      },
      ScalarInput{"shear_rate"}, ScalarInput{"pressure"}, ScalarInput{"pressure_floor"}, ScalarInput{"mean_diameter"},
      ScalarInput{"density"}, ScalarInput{"phi"});
  registry.add(std::move(s));
}

}  // namespace grainvdb
