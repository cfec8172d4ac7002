#include <cmath>
#include <limits>

#include "fields/fluctuation.hpp"
#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

std::string mode_of(const StageSettings& settings) {
  return option<std::string>(settings, "temperature", "mode");
}

MomentPtr temperature_moment(const StageSettings& settings) {
  const Fluctuating velocity{"velocity", Column::velocity, &Particles::velocity, velocity_numerator(settings),
                             velocity_denominator(settings)};
  const std::string mode = mode_of(settings);
  return fluctuation_moment(velocity, mode == "one_pass_corrected" ? "one_pass" : mode,
                            homogeneous_axes(settings, "temperature"));
}

/// T -= (c²/12) L:L, the part of the one-pass variance that a linear flow u = L x has by itself (physics section 3).
void subtract_gradient_part(const StageInput& in, SparseField& temperature) {
  const SparseField& gradient = in.field("velocity_gradient");
  const double factor = in.kernel().cutoff() * in.kernel().cutoff() / 12;
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    float* t = temperature.leaf(leaf);
    in.topology().mask(leaf).for_each([&](int v) {
      double squares = 0;
      for (int c = 0; c < 9; ++c) {
        const double l = gradient.leaf(leaf, c)[v];
        squares += l * l;
      }
      t[v] = static_cast<float>(t[v] - factor * squares);
      if (t[v] < 0) {
        t[v] = std::numeric_limits<float>::quiet_NaN();
        in.mask().add(leaf, v, Reason::negative_temperature);
      }
    });
  });
}

}  // namespace

void register_temperature(StageRegistry& registry) {
  Stage s;
  s.name = "temperature";
  s.dimension = dimension::velocity_squared;
  s.description = "granular temperature, the sum over the components of the velocity fluctuation";
  s.equation = "T = sum V |v - u(x_a)|^2 W / sum V W, u of the frame  (A14, A15)";
  std::vector<std::string> modes = fluctuation_modes;
  modes.emplace_back("one_pass_corrected");
  s.options = {
      {.name = "mode",
       .default_value = std::string("two_pass"),
       .help = "two_pass: about the frame's u at the particle (A15); two_pass_profile: about u averaged over the "
               "homogeneous axes; one_pass: second moments about the mean at the voxel; one_pass_corrected: "
               "less (c^2/12) L:L",
       .choices = modes},
      homogeneous_option()};
  s.needs = [](const StageSettings& settings) {
    StageNeeds needs{{}, {temperature_moment(settings), volume_moment()}};
    if (mode_of(settings) == "one_pass_corrected") needs.fields.emplace_back("velocity_gradient");
    return needs;
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_ratio(in, *temperature_moment(in.settings()), *volume_moment(), out);
    if (mode_of(in.settings()) == "one_pass_corrected") subtract_gradient_part(in, out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
