#pragma once
/// The keys of a pipeline file for what some formats of dumps leave unsaid.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_unsaid_keys(Schema& schema);

}  // namespace grainvdb
