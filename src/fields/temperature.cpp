#include "fields/fluctuation.hpp"
#include "fields/moments.hpp"
#include "fields/register.hpp"

namespace grainvdb {

void register_temperature(StageRegistry& registry) {
  Stage s;
  s.name = "temperature";
  s.dimension = dimension::velocity_squared;
  s.by_species = true;
  s.description = "granular temperature, the sum over the components of the velocity fluctuation";
  s.equation = "T = sum V |v - u(x_a)|^2 W / sum V W, u of the frame  (A14, A15)";
  set_fluctuation(s, {.stage = s.name,
                      .label = "velocity",
                      .column = Column::velocity,
                      .vector = &Particles::velocity,
                      .mean_numerator = velocity_numerator,
                      .mean_denominator = velocity_denominator,
                      .gradient = "velocity_gradient"});
  registry.add(std::move(s));
}

}  // namespace grainvdb
