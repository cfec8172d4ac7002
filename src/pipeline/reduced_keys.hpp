#pragma once
/// The section of a pipeline file on the units of what is written.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_reduced_keys(Schema& schema);

/// Whether numbers in these units can be written in single precision, those of the registry's fields among them. Throws
/// ConfigError.
void check_reduced(const Pipeline& pipeline, const StageRegistry& registry);

/// That there is something to write where there is an output. Throws ConfigError.
void check_output(const Pipeline& pipeline, const Schema& schema);

}  // namespace grainvdb
