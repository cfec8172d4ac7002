#include <cmath>

#include "derive/register.hpp"
#include "derive/voxelwise.hpp"
#include "fields/resolution.hpp"

namespace grainvdb {
namespace {

/// Whether the spins fluctuate by more than their threshold and their rounding.
auto spin_fluctuates(const StageSettings& settings) {
  const double least = option<double>(settings, "g_over_domega", "rotational_fluctuation_min");
  const double resolution = option<double>(settings, "angular_velocity", "resolution");
  return [=](double fluctuation, const Vec3& spin) {
    return fluctuation > least && fluctuation >= noise_square(resolution, spin);
  };
}

Stage rotational_temperature() {
  Stage s;
  s.name = "rotational_temperature";
  s.dimension = dimension::velocity_squared;
  s.description = "rotational temperature of solid spheres";
  s.equation = "Theta = d^2 dw^2/10  (A22), (A23)";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes&, double d, double fluctuation) { return d * d * fluctuation / 10; };
      },
      ScalarInput{"mean_diameter"}, ScalarInput{"rotational_fluctuation"});
  return s;
}

Stage g_over_domega() {
  Stage s;
  s.name = "g_over_domega";
  s.description = "rotational dimensionless fluidity g/dw";
  s.equation = "g/sqrt(dw^2)  (A24)";
  s.options = {{.name = "rotational_fluctuation_min",
                .default_value = 0.0,
                .help = "this and dv_over_d_domega are undefined where dw^2 <= rotational_fluctuation_min [1/time^2], "
                        "or below (angular_velocity.resolution |omega|)^2",
                .minimum = 0}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        return [spins = spin_fluctuates(settings)](VoxelNotes& notes, double g, double fluctuation, const Vec3& spin) {
          return spins(fluctuation, spin) ? g / std::sqrt(fluctuation) : notes.undefined(Reason::no_spin_fluctuation);
        };
      },
      ScalarInput{"fluidity"}, ScalarInput{"rotational_fluctuation"}, VectorInput{"angular_velocity"});
  return s;
}

// T = temperature_min is kept, since δv = 0 is a value here; below it, as where the one-pass T is negative or within
// the rounding of the velocities, it is none.
Stage dv_over_d_domega() {
  Stage s;
  s.name = "dv_over_d_domega";
  s.description = "translational over rotational fluctuation dv/(d dw)";
  s.equation = "sqrt(T)/(d sqrt(dw^2))  (A25)";
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double temperature_min = option<double>(settings, "gd_over_dv", "temperature_min");
        const double resolution = option<double>(settings, "velocity", "resolution");
        return [=, spins = spin_fluctuates(settings)](VoxelNotes& notes, double temperature, double d,
                                                      double fluctuation, const Vec3& u, const Vec3& spin) {
          const bool still = !(temperature >= temperature_min) || temperature < noise_square(resolution, u);
          const bool no_spin = !spins(fluctuation, spin);
          if (still) notes.add(Reason::no_fluctuation);
          if (no_spin) notes.add(Reason::no_spin_fluctuation);
          return still || no_spin ? std::nan("") : std::sqrt(temperature / fluctuation) / d;
        };
      },
      ScalarInput{"temperature"}, ScalarInput{"mean_diameter"}, ScalarInput{"rotational_fluctuation"},
      VectorInput{"velocity"}, VectorInput{"angular_velocity"});
  return s;
}

}  // namespace

void register_spin(StageRegistry& registry) {
  registry.add(rotational_temperature());
  registry.add(g_over_domega());
  registry.add(dv_over_d_domega());
}

}  // namespace grainvdb
