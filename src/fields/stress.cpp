#include "fields/register.hpp"

namespace grainvdb {

void register_stress(StageRegistry& registry) {
  Stage s;
  s.name = "stress";
  s.components = 9;
  s.dimension = dimension::stress;
  s.additive = true;
  s.by_species = true;
  s.description = "total stress, tension positive, row-major ij";
  s.equation = "contact_stress + kinetic_stress  (8)";
  s.needs = [](const StageSettings&) { return StageNeeds{{"contact_stress", "kinetic_stress"}, {}}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    const SparseField& contact = in.field("contact_stress");
    const SparseField& kinetic = in.field("kinetic_stress");
    for_each_leaf(in.topology(), [&](std::size_t leaf) {
      for (int c = 0; c < 9; ++c) {
        const float* a = contact.leaf(leaf, c);
        const float* b = kinetic.leaf(leaf, c);
        float* to = out.leaf(leaf, c);
        in.topology().mask(leaf).for_each([&](int v) { to[v] = a[v] + b[v]; });
      }
    });
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
