#include <cmath>

#include "derive/register.hpp"
#include "derive/voxelwise.hpp"
#include "grainvdb/laws.hpp"

namespace grainvdb {

namespace {

Stage inertial_number() {
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
  return s;
}

Stage regime() {
  Stage s;
  s.name = "regime";
  s.description = "regime of the flow: 0 quasi-static, 1 intermediate, 2 inertial";
  s.equation = "0 where I < quasi_static_below, 2 where I > inertial_above, else 1";
  s.options = {{.name = "quasi_static_below",
                .default_value = RegimeBounds{}.quasi_static,
                .help = "inertial number below which flow is quasi-static",
                .minimum = 0},
               {.name = "inertial_above",
                .default_value = RegimeBounds{}.inertial,
                .help = "inertial number above which flow is inertial",
                .minimum = 0}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        const RegimeBounds bounds{option<double>(settings, "regime", "quasi_static_below"),
                                  option<double>(settings, "regime", "inertial_above")};
        return [bounds](VoxelNotes&, double inertial_number) { return static_cast<double>(bounds(inertial_number)); };
      },
      ScalarInput{"inertial_number"});
  return s;
}

}  // namespace

void register_rheology(StageRegistry& registry) {
  registry.add(inertial_number());
  registry.add(regime());
}

}  // namespace grainvdb
