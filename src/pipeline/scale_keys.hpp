#pragma once
/// The keys of the section `scales`.
#include <map>
#include <string>

#include "pipeline/schema.hpp"

namespace grainvdb {

void add_scale_keys(Schema& schema);

/// Refuses scales that do not make pairs (ConfigError), and gives each of the others its resolved pipeline. `values`
/// are those of the whole file.
void complete_scales(Pipeline& pipeline, const Schema& schema, std::map<std::string, ConfigValue> values);

}  // namespace grainvdb
