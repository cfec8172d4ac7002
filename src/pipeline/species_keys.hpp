#pragma once
/// The section `species`.
#include <string>

#include "pipeline/config_node.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_species(Schema& schema);

/// The species of a pipeline file, before the rest of it is checked: the names of fields hang on them.
Pipeline with_species_of(const ConfigNode& root, const std::string& file, const Schema& schema);

/// Refuses species that cannot be told apart, whatever the grains are (ConfigError).
void check_species(const Pipeline& pipeline);

/// For keys that name fields: which there are of species, in words; nothing without species.
std::string hint_at_species(const StageRegistry& registry);
/// For the JSON schema, which does not know the species of a file: a regular expression of the names that their fields
/// can have.
std::string pattern_of_species(const StageRegistry& registry);

}  // namespace grainvdb
