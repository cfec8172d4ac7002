#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/resolution.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {

void register_angular_velocity(StageRegistry& registry) {
  Stage s;
  s.name = "angular_velocity";
  s.components = 3;
  s.dimension = dimension::rate;
  s.description = "mean angular velocity of the particles";
  s.equation = "omega = sum V omega_a W / sum V W  (A16)";
  s.options = {resolution_option("ratios to smaller fluctuations are undefined")};
  s.needs = [](const StageSettings&) { return StageNeeds{{}, {volume_spin_moment(), volume_moment()}}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_ratio(in, *volume_spin_moment(), *volume_moment(), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
