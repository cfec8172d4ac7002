#pragma once
/// A file of keys and values, checked against a schema: pipeline files and what else has sections and keys.
#include <map>
#include <string>
#include <vector>

#include "pipeline/config_node.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {

struct CheckedConfig {
  std::map<std::string, ConfigValue> values;  ///< by path of key, defaults filled in
  std::map<std::string, Location> places;     ///< of the sections and keys that were given; overrides stand at "--set"
};

/// Reads a file of the version of the schema, none of which is checked yet; `overrides` are as for load_config. Throws
/// ConfigError or IoError.
ConfigNode read_with_overrides(const std::string& file, const std::vector<std::string>& overrides,
                               const Schema& schema);

/// What was read, checked. Throws ConfigError as load_config does.
CheckedConfig check_config(const ConfigNode& root, const std::string& file, const Schema& schema);

/// Reads a file; `overrides` are "a.b=value" texts that win over it. Throws ConfigError with file and line for anything
/// that the schema does not allow, or IoError.
CheckedConfig load_config(const std::string& file, const std::vector<std::string>& overrides, const Schema& schema);

}  // namespace grainvdb
