#pragma once
/// The `measure:` section of pipeline files: one section for each measurement, from the registry.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_measure(Schema& schema, const StageRegistry& registry);

/// Refuses options that do not go together (ConfigError).
void check_measure(const Pipeline& pipeline);

}  // namespace grainvdb
