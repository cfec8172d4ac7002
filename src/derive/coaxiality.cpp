#include <cmath>

#include "derive/register.hpp"
#include "derive/tensor.hpp"
#include "derive/voxelwise.hpp"

namespace grainvdb {
namespace {

/// The angle between two axes without direction, 0 … π/2, accurate near both ends (acos is not).
double angle_between_axes(const Vec3& a, const Vec3& b) {
  const Vec3 cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return std::atan2(std::hypot(cross[0], cross[1], cross[2]), std::abs(dot));
}

}  // namespace

void register_coaxiality(StageRegistry& registry) {
  Stage s;
  s.name = "coaxiality_angle";
  s.description = "angle between the most compressive axis of the stress and the most contractile axis of D [rad]";
  s.equation = "acos|a(sigma).a(D)|, 0 to pi/2; a: eigenvector of the least eigenvalue (tension, extension positive)";
  s.options = {{.name = "gap",
                .default_value = 1e-5,
                .help = "undefined where the most contractile rate is within gap max|D_k| of the next; "
                        "for the stress principal_axes.gap applies",
                .minimum = 0,
                .maximum = 2},
               {.name = "shear_rate_min",
                .default_value = 0.0,
                .help = "undefined where the shear rate <= shear_rate_min [1/time]",
                .minimum = 0}};
  set_formula(
      s,
      [](const StageSettings& settings) {
        const double stress_gap = option<double>(settings, "principal_axes", "gap");
        const double strain_gap = option<double>(settings, "coaxiality_angle", "gap");
        const double rate_min = option<double>(settings, "coaxiality_angle", "shear_rate_min");
        return [=](VoxelNotes& notes, const Tensor& stress, const Tensor& velocity_gradient) {
          const PrincipalFrame of_stress = principal_frame(stress);
          const PrincipalFrame of_strain = principal_frame(velocity_gradient);
          const bool no_stress_axis = !(of_stress.relative_gap(1) > stress_gap);
          const bool no_strain_axis =
              !(of_strain.relative_gap(1) > strain_gap) || !(shear_rate_of(velocity_gradient) > rate_min);
          if (no_stress_axis) notes.add(Reason::degenerate_stress_axes);
          if (no_strain_axis) notes.add(Reason::degenerate_strain_axes);
          return no_stress_axis || no_strain_axis ? std::nan("")
                                                  : angle_between_axes(of_stress.axes[2], of_strain.axes[2]);
        };
      },
      TensorInput{"stress"}, TensorInput{"velocity_gradient"});
  registry.add(std::move(s));
}

}  // namespace grainvdb
