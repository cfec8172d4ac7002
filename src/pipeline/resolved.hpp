#pragma once
/// A validated pipeline written out in full.
#include <map>
#include <string>

#include "pipeline/schema.hpp"

namespace grainvdb {

/// The values by path of key as YAML, in the order of the schema. Saved beside the original file it loads as the same
/// pipeline.
std::string resolved_yaml(const Schema& schema, const std::map<std::string, ConfigValue>& values);

}  // namespace grainvdb
