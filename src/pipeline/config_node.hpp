#pragma once
/// A YAML text as a tree that knows where each key and value stands. Everything that YAML allows and a pipeline file
/// has no use for is refused here: repeated keys, several documents, tags, merge keys, aliases that contain themselves
/// or that multiply without bound.
#include <cstddef>
#include <string>
#include <vector>

#include "grainvdb/error.hpp"

namespace grainvdb {

struct ConfigEntry;

struct ConfigNode {
  enum class Kind { null, scalar, sequence, mapping };
  Kind kind = Kind::null;
  std::string text;     ///< of a scalar, quotes removed
  bool quoted = false;  ///< a scalar in quotes or a block scalar: a text, never a number
  Location where;
  std::vector<ConfigNode> items;     ///< of a sequence
  std::vector<ConfigEntry> entries;  ///< of a mapping, in the order of the file

  /// The value of a key of a mapping; nullptr when it is not there.
  ConfigNode* find(const std::string& key);
  /// "a list", "nothing", … for error messages.
  std::string kind_name() const;
};

struct ConfigEntry {
  std::string key;
  Location where;
  ConfigNode value;
};

/// Bounds on what is read, far above any sensible pipeline file.
namespace config_limit {
inline constexpr std::size_t file_bytes = std::size_t{4} << 20;
inline constexpr std::size_t nodes = 100'000;                     ///< after aliases are expanded
inline constexpr std::size_t text_bytes = std::size_t{16} << 20;  ///< of all scalars, after aliases are expanded
inline constexpr std::size_t depth = 32;
}  // namespace config_limit

/// Reads a file; throws IoError when that fails, else as parse_config.
ConfigNode read_config(const std::string& file);

/// Parses the text of a file, the lines of which are reported. An anchored node is copied wherever an alias names it.
/// Throws ConfigError.
ConfigNode parse_config(const std::string& text, const std::string& file);

/// Parses a value given on the command line; every node stands at `where`.
ConfigNode parse_config_value(const std::string& text, const Location& where);

}  // namespace grainvdb
