#pragma once
/// A node of a pipeline file as the value that its key declares.
#include "pipeline/config_node.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {

/// Throws ConfigError at the node for a wrong type, a value outside the range or choices, a repeated item or a list of
/// the wrong length.
ConfigValue convert(const KeyInfo& key, const ConfigNode& node);

}  // namespace grainvdb
