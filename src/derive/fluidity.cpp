#include <cmath>

#include "derive/register.hpp"
#include "derive/voxelwise.hpp"
#include "fields/resolution.hpp"

namespace grainvdb {
namespace {

// An isotropic stress in float has |σ|/P of the order of its rounding, 6e-8, instead of 0; 1e-6 keeps clear of that.
Stage fluidity() {
  Stage s;
  s.name = "fluidity";
  s.dimension = dimension::rate;
  s.description = "granular fluidity g";
  s.equation = "g = |gd|/mu  (1)";
  s.options = {
      {.name = "mu_min",
       .default_value = 1e-6,
       .help = "undefined where mu <= mu_min: a stress that is isotropic to rounding has no ratio to divide by",
       .minimum = 0}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double mu_min = option<double>(settings, "fluidity", "mu_min");
        return [mu_min](VoxelNotes& notes, double rate, double mu) {
          return mu > mu_min ? rate / mu : notes.undefined(Reason::no_shear_stress);
        };
      },
      ScalarInput{"shear_rate"}, ScalarInput{"mu"});
  return s;
}

Stage gd_over_dv() {
  Stage s;
  s.name = "gd_over_dv";
  s.description = "dimensionless granular fluidity g d/dv, dv^2 = T the sum over components";
  s.equation = "g d/sqrt(T)  (2)";
  s.options = {{.name = "temperature_min",
                .default_value = 0.0,
                .help = "undefined where the granular temperature <= temperature_min [velocity^2], or below "
                        "(velocity.resolution |u|)^2",
                .minimum = 0}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double temperature_min = option<double>(settings, "gd_over_dv", "temperature_min");
        const double resolution = option<double>(settings, "velocity", "resolution");
        return [=](VoxelNotes& notes, double g, double d, double temperature, const Vec3& u) {
          const bool fluctuates = temperature > temperature_min && temperature >= noise_square(resolution, u);
          return fluctuates ? g * d / std::sqrt(temperature) : notes.undefined(Reason::no_fluctuation);
        };
      },
      ScalarInput{"fluidity"}, ScalarInput{"mean_diameter"}, ScalarInput{"temperature"}, VectorInput{"velocity"});
  return s;
}

}  // namespace

void register_fluidity(StageRegistry& registry) {
  registry.add(fluidity());
  registry.add(gd_over_dv());
}

}  // namespace grainvdb
