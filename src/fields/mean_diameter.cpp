#include "fields/moments.hpp"
#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {

void register_mean_diameter(StageRegistry& registry) {
  Stage s;
  s.name = "mean_diameter";
  s.dimension = dimension::length;
  s.by_species = true;
  s.description = "volume-weighted mean diameter";
  s.equation = "d = sum V d_a W / sum V W  (A19)";
  s.needs = [](const StageSettings&) { return StageNeeds{{}, {volume_diameter_moment(), volume_moment()}}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_ratio(in, *volume_diameter_moment(), *volume_moment(), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
