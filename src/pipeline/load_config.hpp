#pragma once
/// A file of keys and values, checked against a schema: pipeline files and what else has sections and keys.
#include <map>
#include <string>
#include <vector>

#include "pipeline/schema.hpp"

namespace grainvdb {

struct CheckedConfig {
  std::map<std::string, ConfigValue> values;  ///< by path of key, defaults filled in
  std::map<std::string, Location> places;     ///< of the sections and keys that were given; overrides stand at "--set"
};

/// Reads a file; `overrides` are "a.b=value" texts that win over it. Throws ConfigError with file and line for anything
/// that the schema does not allow, or IoError.
CheckedConfig load_config(const std::string& file, const std::vector<std::string>& overrides, const Schema& schema);

}  // namespace grainvdb
