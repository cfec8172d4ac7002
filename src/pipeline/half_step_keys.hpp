#pragma once
/// The section of a pipeline file on the contact law behind dumped forces.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_half_step_keys(Schema& schema);

/// What no single key can tell: that the keys are those of the law. Throws ConfigError.
void check_half_step(const Pipeline& pipeline);

}  // namespace grainvdb
