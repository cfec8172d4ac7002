#include "fields/fluctuation.hpp"
#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

MomentPtr spin_fluctuation_moment(const StageSettings& settings) {
  const Fluctuating spin{"angular velocity", Column::angular_velocity, &Particles::angular_velocity,
                         volume_spin_moment(), volume_moment()};
  return fluctuation_moment(spin, option<std::string>(settings, "rotational_fluctuation", "mode"),
                            homogeneous_axes(settings, "rotational_fluctuation"));
}

}  // namespace

void register_rotational_fluctuation(StageRegistry& registry) {
  Stage s;
  s.name = "rotational_fluctuation";
  s.dimension = dimension::rate_squared;
  s.description = "rotational fluctuation, the sum over the components of the angular-velocity fluctuation";
  s.equation = "domega^2 = sum V |omega_a - omega(x_a)|^2 W / sum V W, omega of the frame  (A17, A18)";
  s.options = {{.name = "mode",
                .default_value = std::string("two_pass"),
                .help = "as temperature.mode, about the mean angular velocity",
                .choices = fluctuation_modes},
               homogeneous_option()};
  s.needs = [](const StageSettings& settings) {
    return StageNeeds{{}, {spin_fluctuation_moment(settings), volume_moment()}};
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_ratio(in, *spin_fluctuation_moment(in.settings()), *volume_moment(), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
