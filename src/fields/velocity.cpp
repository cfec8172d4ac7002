#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/resolution.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {

void register_velocity(StageRegistry& registry) {
  Stage s;
  s.name = "velocity";
  s.components = 3;
  s.by_species = true;
  s.dimension = dimension::velocity;
  s.description = "velocity";
  s.equation = "u = sum V v W / sum V W  (7); m for V when mass-weighted";
  s.options = {{.name = "weighting",
                .default_value = std::string("volume"),
                .help = "weight of each particle: volume as (7), or mass as the momentum balance wants it",
                .choices = {"volume", "mass"}},
               resolution_option("ratios to smaller fluctuations, or to the pressure these would have, are undefined")};
  s.needs = [](const StageSettings& settings) {
    return StageNeeds{{}, {velocity_numerator(settings), velocity_denominator(settings)}};
  };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_ratio(in, *velocity_numerator(in.settings()), *velocity_denominator(in.settings()), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
