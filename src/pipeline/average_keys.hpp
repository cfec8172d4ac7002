#pragma once
/// The section of a pipeline file on averages over time.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_average_keys(Schema& schema, const StageRegistry& registry);

}  // namespace grainvdb
