#include <algorithm>
#include <cmath>

#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"
#include "fields/resolution.hpp"

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
                .help = "fields that are ratios to the pressure are undefined where P <= pressure_min [stress], or "
                        "below pressure_floor",
                .minimum = 0}};
  set_formula(
      s, [](const StageSettings&) { return [](VoxelNotes&, const Tensor& stress) { return -trace(stress) / 3; }; },
      TensorInput{"stress"});
  return s;
}

double pressure_min_of(const StageSettings& settings) {
  return option<double>(settings, "pressure", "pressure_min");
}
double resolution_of(const StageSettings& settings) {
  return option<double>(settings, "velocity", "resolution");
}

// Grains that fall or move side by side have no pressure; what their velocities' rounding leaves of the kinetic stress
// is no number to divide by. Where there is no material, only contacts give a pressure, and nothing was rounded.
Stage pressure_floor() {
  Stage s;
  s.name = "pressure_floor";
  s.dimension = dimension::stress;
  s.additive = true;
  s.description = "the pressure up to which ratios to the pressure are undefined";
  s.equation = "max(pressure_min, rho (velocity.resolution |u|)^2)";
  s.needs = [](const StageSettings& settings) {
    return resolution_of(settings) > 0 ? StageNeeds{{"density", "velocity"}, {}} : StageNeeds{};
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    const double least = pressure_min_of(in.settings());
    const double resolution = resolution_of(in.settings());
    for_each_leaf(in.topology(), [&](std::size_t leaf) {
      in.topology().mask(leaf).for_each([&](int v) {
        double noise = 0;
        if (resolution > 0 && in.field("density").leaf(leaf)[v] > 0) {
          const SparseField& u = in.field("velocity");
          noise = in.field("density").leaf(leaf)[v] *
                  noise_square(resolution, {u.leaf(leaf, 0)[v], u.leaf(leaf, 1)[v], u.leaf(leaf, 2)[v]});
        }
        out.leaf(leaf)[v] = static_cast<float>(std::max(least, noise));
      });
    });
  };
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
      [](const StageSettings&) {
        return [](VoxelNotes& notes, double p, double floor, double tau) {
          return p > floor ? tau / p : notes.undefined(Reason::low_pressure);
        };
      },
      ScalarInput{"pressure"}, ScalarInput{"pressure_floor"}, ScalarInput{"shear_stress"});
  return s;
}

}  // namespace

void register_stress_invariants(StageRegistry& registry) {
  registry.add(pressure());
  registry.add(pressure_floor());
  registry.add(shear_stress());
  registry.add(mu());
}

}  // namespace grainvdb
