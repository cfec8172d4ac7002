#include "measure/partial_field.hpp"

namespace grainvdb {

PartialField partial_field(const std::string& name) {
  const StageRegistry& registry = StageRegistry::standard();
  if (const Stage* all = registry.find(name)) return {all};
  for (const Stage& all : registry.stages())
    if (all.by_species && name.size() > all.name.size() + 1 && name.starts_with(all.name + '_'))
      return {&all, name.substr(all.name.size() + 1)};
  return {};
}

}  // namespace grainvdb
