#include <cmath>
#include <numbers>

#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {
namespace {

// The smaller of the two extreme compressive stresses must be positive beyond its rounding error, which is that of the
// largest component.
Stage mu_mohr_coulomb() {
  Stage s;
  s.name = "mu_mohr_coulomb";
  s.description = "Mohr-Coulomb stress ratio: the friction coefficient at which the state would be yielding";
  s.equation = "(p3 - p1)/(2 sqrt(p3 p1)), p1 < p3 the extreme principal stresses, compression positive";
  set_formula(
      s,
      [](const StageSettings&) {
        return [](VoxelNotes& notes, double pressure, double floor, const Vec3& principal) {
          const double least = -principal[0];
          const double most = -principal[2];
          const bool low = !(pressure > floor);
          const bool tensile = !(least > float_tensor_rounding * most);
          if (low) notes.add(Reason::low_pressure);
          if (tensile) notes.add(Reason::tensile_stress);
          return low || tensile ? std::nan("") : (most - least) / (2 * std::sqrt(most * least));
        };
      },
      ScalarInput{"pressure"}, ScalarInput{"pressure_floor"}, VectorInput{"principal_stress"});
  return s;
}

using SlipLines = std::array<double, 6>;

/// The two directions at ±(π/4 - φ_f/2) from the most compressive axis, in the plane of the extreme axes.
SlipLines slip_lines_of(const Tensor& axes, double friction_angle) {
  const double epsilon = std::numbers::pi / 4 - friction_angle / 2;
  const double c = std::cos(epsilon);
  const double s = std::sin(epsilon);
  SlipLines lines{};
  for (std::size_t i = 0; i < 3; ++i) {
    lines[i] = c * axes[6 + i] + s * axes[i];
    lines[3 + i] = c * axes[6 + i] - s * axes[i];
  }
  return lines;
}

bool uses_given_angle(const StageSettings& settings) {
  return option<std::string>(settings, "slip_lines", "friction") == "given";
}

// The mobilised angle atan μ_MC takes the material to be at incipient yield everywhere; the given one is that of the
// material, whether or not it yields.
Stage slip_lines() {
  Stage s;
  s.name = "slip_lines";
  s.components = 6;
  s.description = "two unit vectors along the Mohr-Coulomb slip lines, either side of the most compressive axis";
  s.equation =
      "cos(e) a3 + sin(e) a1 and cos(e) a3 - sin(e) a1, e = pi/4 - phi_f/2, a1 and a3 rows 0 and 2 of principal_axes";
  s.options = {{.name = "friction",
                .default_value = std::string("mobilised"),
                .help = "phi_f: mobilised (atan mu_mohr_coulomb at each voxel) or given (friction_angle everywhere)",
                .choices = {"mobilised", "given"}},
               {.name = "friction_angle",
                .default_value = 0.5,
                .help = "internal friction angle phi_f [rad], used when friction is `given`",
                .minimum = 0,
                .maximum = std::numbers::pi / 2}};
  s.needs = [](const StageSettings& settings) {
    StageNeeds needs{{"principal_axes"}, {}};
    if (!uses_given_angle(settings)) needs.fields.emplace_back("mu_mohr_coulomb");
    return needs;
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    const TensorInput axes{"principal_axes"};
    if (uses_given_angle(in.settings())) {
      const double angle = option<double>(in.settings(), "slip_lines", "friction_angle");
      for_each_voxel(
          in, out, [angle](VoxelNotes&, const Tensor& a) { return slip_lines_of(a, angle); }, axes);
    } else {
      for_each_voxel(
          in, out, [](VoxelNotes&, const Tensor& a, double mu) { return slip_lines_of(a, std::atan(mu)); }, axes,
          ScalarInput{"mu_mohr_coulomb"});
    }
  };
  return s;
}

}  // namespace

void register_mohr_coulomb(StageRegistry& registry) {
  registry.add(mu_mohr_coulomb());
  registry.add(slip_lines());
}

}  // namespace grainvdb
