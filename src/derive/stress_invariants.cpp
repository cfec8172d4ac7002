#include <cmath>

#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {
namespace {

Stage pressure() {
  Stage s;
  s.name = "pressure";
  s.dimension = dimension::stress;
  s.additive = true;  // linear in the stress
  s.description = "pressure, positive in compression";
  s.equation = "P = -Tr(sigma)/3  (A11)";
  s.options = {{.name = "pressure_min",
                .default_value = 0.0,
                .help = "fields that are ratios to the pressure are undefined where P <= pressure_min [stress]",
                .minimum = 0}};
  set_formula(
      s, [](const StageSettings&) { return [](VoxelNotes&, const Tensor& stress) { return -trace(stress) / 3; }; },
      TensorInput{"stress"});
  return s;
}

// The contact stress is not symmetric where contacts carry moments; (A12) sums over all components of the deviator.
Stage shear_stress() {
  Stage s;
  s.name = "shear_stress";
  s.dimension = dimension::stress;
  s.description = "equivalent shear stress |sigma|, of the full (also the antisymmetric) deviator";
  s.equation = "|sigma| = sqrt(sigma':sigma'/2), sigma' = sigma + P 1  (A12), (A13)";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes&, const Tensor& stress) { return std::sqrt(0.5 * deviator_square(stress)); };
      },
      TensorInput{"stress"});
  return s;
}

Stage mu() {
  Stage s;
  s.name = "mu";
  s.description = "stress ratio";
  s.equation = "mu = |sigma|/P";
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double pressure_min = option<double>(settings, "pressure", "pressure_min");
        return [pressure_min](VoxelNotes& notes, double p, double tau) {
          return p > pressure_min ? tau / p : notes.undefined(Reason::low_pressure);
        };
      },
      ScalarInput{"pressure"}, ScalarInput{"shear_stress"});
  return s;
}

}  // namespace

void register_stress_invariants(StageRegistry& registry) {
  registry.add(pressure());
  registry.add(shear_stress());
  registry.add(mu());
}

}  // namespace grainvdb
