#pragma once
/// The declaration of pipeline files: every section and key with type, unit, range, default and help. It alone feeds
/// the validation, the resolved pipeline, the JSON schema and the help texts. The options of stages come from their
/// registry.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "grainvdb/pipeline.hpp"

namespace grainvdb {

enum class ValueType {
  boolean,
  integer,
  number,
  text,
  texts,  ///< a list of texts; a single text stands for a list of one
  integers,
  numbers,
  items,        ///< a list of sections, each of one of several kinds
  named_items,  ///< sections of one kind by names that the user chooses
  points,       ///< a list of lists of three numbers
  frame_range,  ///< "3", "a:b" or "a:b:c"; kept as text
  window        ///< the text "all" or "none", or a number of frames
};

struct ConfigItem;
/// A value of a pipeline file; which alternative follows from the type of its key.
using ConfigValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<std::int64_t>,
                 std::vector<double>, std::vector<Vec3>, std::vector<ConfigItem>>;

/// A section in a list of sections, or among named ones.
struct ConfigItem {
  std::string kind;                                         ///< or its name, where the user chooses it
  std::vector<std::pair<std::string, ConfigValue>> values;  ///< by name, defaults filled in
  /// nullptr where there is none of that name.
  const ConfigValue* find(const std::string& name) const;
};

struct ItemKind;

struct KeyInfo {
  std::string section;  ///< path of the section, e.g. "input.contacts"; empty at the top
  std::string name;
  ValueType type = ValueType::text;
  std::string help;
  std::string unit{};     ///< of numbers, in words, e.g. "length"
  bool required = false;  ///< wherever its section is given
  std::optional<ConfigValue> default_value{};
  std::vector<std::string> choices{};  ///< of texts; empty: anything
  std::string name_pattern{};          ///< for the JSON schema: a regular expression of names of sections that the user
                                       ///< chooses, or of texts beside the choices that the file may define elsewhere
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool above_minimum = false;  ///< the minimum itself is not allowed
  bool infinite_allowed = false;
  std::size_t fewest = 1;  ///< items of a list
  std::size_t most = std::numeric_limits<std::size_t>::max();
  bool one_for_all = false;       ///< of a list of fixed length: one number may stand for all items
  std::vector<ItemKind> kinds{};  ///< of the items of a list of sections; one for named sections
  std::string hint{};             ///< added to errors about this key
  std::function<void(Pipeline&, const ConfigValue&)> apply{};

  std::string path() const { return section.empty() ? name : section + '.' + name; }
};

/// A kind of section in a list: an item `name: {keys}`.
struct ItemKind {
  std::string name;
  std::string help;
  std::vector<KeyInfo> keys;
};

struct SectionInfo {
  std::string path;
  std::string help;
  bool required = false;  ///< wherever the section around it is given
  bool optional = false;  ///< defaults of keys in it and below hold only where it is given

  std::string parent() const;
  std::string name() const;
};

/// A section by which files of another kind give themselves away.
struct ForeignSection {
  std::string name;
  std::string kind;     ///< of file, e.g. "a spot file"
  std::string command;  ///< that takes such files
};

struct Schema {
  std::vector<SectionInfo> sections;  ///< a section comes after the one around it
  std::vector<KeyInfo> keys;
  std::vector<ForeignSection> foreign{};  ///< at the top

  /// nullptr when there is none.
  const KeyInfo* find_key(const std::string& section, const std::string& name) const;
  const SectionInfo* find_section(const std::string& path) const;
  /// Names of the keys and sections directly in a section.
  std::vector<std::string> names_in(const std::string& section) const;
};

Schema make_schema(const StageRegistry& registry);

/// The declaration as JSON Schema (draft 7), with a title and what the whole file is for.
std::string json_schema(const Schema& schema, const std::string& title, const std::string& help);

/// What a key accepts in words, e.g. "a number > 0 [length]".
std::string accepted(const KeyInfo& key);

}  // namespace grainvdb
