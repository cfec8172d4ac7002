#include "fields/fluctuation.hpp"
#include "fields/moments.hpp"
#include "fields/register.hpp"

namespace grainvdb {

void register_rotational_fluctuation(StageRegistry& registry) {
  Stage s;
  s.name = "rotational_fluctuation";
  s.dimension = dimension::rate_squared;
  s.description = "rotational fluctuation, the sum over the components of the angular-velocity fluctuation";
  s.equation = "domega^2 = sum V |omega_a - omega(x_a)|^2 W / sum V W, omega of the frame  (A17, A18)";
  set_fluctuation(s, {.stage = s.name,
                      .label = "angular velocity",
                      .column = Column::angular_velocity,
                      .vector = &Particles::angular_velocity,
                      .mean_numerator = [](const StageSettings&) { return volume_spin_moment(); },
                      .mean_denominator = [](const StageSettings&) { return volume_moment(); },
                      .gradient = "angular_velocity_gradient"});
  registry.add(std::move(s));
}

}  // namespace grainvdb
