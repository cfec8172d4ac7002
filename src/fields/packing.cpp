#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

/// A field that is one averaged moment.
Stage moment_stage(MomentPtr moment) {
  Stage s;
  s.additive = true;
  s.by_species = true;
  s.needs = [moment](const StageSettings&) { return StageNeeds{{}, {moment}}; };
  s.compute = [moment](const StageInput& in, SparseField& out) { write_moment(in, *moment, out); };
  return s;
}

}  // namespace

void register_packing(StageRegistry& registry) {
  Stage phi = moment_stage(volume_moment());
  phi.name = "phi";
  phi.description = "packing fraction";
  phi.equation = "phi = sum V W(x - x_a)  (6)";
  registry.add(std::move(phi));

  Stage density = moment_stage(mass_moment());
  density.name = "density";
  density.dimension = dimension::density;
  density.description = "mass density";
  density.equation = "rho = sum m W(x - x_a)";
  registry.add(std::move(density));
}

}  // namespace grainvdb
