#pragma once
/// The keys of the `trace:` section.
#include "grainvdb/pipeline.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_trace(Schema& schema, const StageRegistry& registry);

/// What no single key of the section can tell. Throws ConfigError.
void check_trace(const Pipeline& pipeline);

}  // namespace grainvdb
