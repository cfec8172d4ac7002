#include "pipeline/load_config.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/config_node.hpp"
#include "pipeline/convert.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

// Puts the value of an override in its place in the tree. A section that is set to nothing is left out.
void apply_override(ConfigNode& root, const std::string& text, const Schema& schema) {
  const Location where{"--set " + text, 0};
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigError({where, "an override must have the form key=value", {}, "e.g. kernel.cutoff=2.4e-3", {}});
  ConfigNode* node = &root;
  ConfigNode* parent = nullptr;
  std::string section, name;
  for (std::size_t begin = 0; begin <= equals;) {
    const std::size_t end = std::min(text.find('.', begin), equals);
    if (!name.empty()) section += (section.empty() ? "" : ".") + name;
    name = text.substr(begin, end - begin);
    if (name.empty()) throw ConfigError({where, "a part of the key is empty", {}, "e.g. kernel.cutoff=2.4e-3", {}});
    if (node->kind != ConfigNode::Kind::mapping) {
      *node = ConfigNode{};  // whatever stood here is no section; the override makes it one
      node->kind = ConfigNode::Kind::mapping;
      node->where = where;
    }
    auto entry = std::find_if(node->entries.begin(), node->entries.end(), [&](const auto& e) { return e.key == name; });
    if (entry == node->entries.end()) entry = node->entries.insert(entry, ConfigEntry{name, where, {}});
    entry->where = end == equals ? where : entry->where;
    parent = node;
    node = &entry->value;
    begin = end + 1;
  }
  const std::string value = text.substr(equals + 1);
  const KeyInfo* key = schema.find_key(section, name);
  const bool is_range = key != nullptr && key->type == ValueType::frame_range;
  if (is_range && !value.starts_with('"') && !value.starts_with('\'')) {
    // "10:" would be a section in YAML.
    *node = ConfigNode{};
    node->kind = ConfigNode::Kind::scalar;
    node->text = value;
    node->where = where;
  } else {
    *node = parse_config_value(value, where);
    const bool is_section = schema.find_section(section.empty() ? name : section + '.' + name) != nullptr;
    if (node->kind == ConfigNode::Kind::null && is_section)
      std::erase_if(parent->entries, [&](const ConfigEntry& e) { return e.key == name; });
  }
}

// Walks the tree along the schema.
class Validation {
 public:
  explicit Validation(const Schema& schema) : schema_(schema) {}

  void check_version(const ConfigNode& root, const std::string& file) const {
    const auto it =
        std::find_if(root.entries.begin(), root.entries.end(), [](const auto& e) { return e.key == "grainvdb"; });
    const KeyInfo& key = *schema_.find_key("", "grainvdb");
    if (it == root.entries.end())
      throw ConfigError({Location{file},
                         "this is not a grainvdb pipeline file: the key 'grainvdb' is missing",
                         {},
                         "grainvdb: 1",
                         {}});
    convert(key, it->value);
  }

  void check_kind(const ConfigNode& root) const {
    for (const ConfigEntry& entry : root.entries)
      for (const ForeignSection& foreign : schema_.foreign)
        if (entry.key == foreign.name)
          throw ConfigError({entry.where,
                             "this is " + foreign.kind,
                             "the section " + quote_text(entry.key),
                             {},
                             "Give it to '" + foreign.command + "'"});
  }

  void section(const std::string& path, const Location& where, const ConfigNode& node) {
    if (node.kind != ConfigNode::Kind::mapping)
      throw ConfigError({node.where,
                         (path.empty() ? "the pipeline file" : "section " + quote_text(path)) +
                             (node.kind == ConfigNode::Kind::null ? " is empty" : " must hold keys"),
                         node.kind == ConfigNode::Kind::null ? "" : node.kind_name(),
                         names_in(path),
                         {}});
    for (const ConfigEntry& entry : node.entries) {
      const std::string child = path.empty() ? entry.key : path + '.' + entry.key;
      if (const KeyInfo* key = schema_.find_key(path, entry.key)) {
        places.emplace(child, entry.where);
        values.emplace(child, convert(*key, entry.value));
        if (key->type == ValueType::items)
          for (std::size_t n = 0; n < entry.value.items.size(); ++n)
            places.emplace(child + '[' + std::to_string(n) + ']', entry.value.items[n].where);
        if (key->type == ValueType::named_items)
          for (const ConfigEntry& named : entry.value.entries) places.emplace(child + '.' + named.key, named.where);
      } else if (entry.key.find('.') == std::string::npos && schema_.find_section(child) != nullptr) {
        places.emplace(child, entry.where);
        section(child, entry.where, entry.value);
      } else {
        unknown(path, entry);
      }
    }
    for (const KeyInfo& key : schema_.keys)
      if (key.section == path && key.required && !values.contains(key.path()))
        throw ConfigError({where, "the key '" + key.path() + "' is missing", {}, accepted(key), {}});
    for (const SectionInfo& s : schema_.sections)
      if (s.parent() == path && s.required && !places.contains(s.path))
        throw ConfigError({where, "the section '" + s.path + "' is missing", {}, names_in(s.path), {}});
  }

  void add_defaults() {
    for (const KeyInfo& key : schema_.keys)
      if (key.default_value && has_defaults(key.section)) values.emplace(key.path(), *key.default_value);
  }

  std::map<std::string, ConfigValue> values;
  std::map<std::string, Location> places;

 private:
  std::string names_in(const std::string& path) const {
    const auto names = schema_.names_in(path);
    return names.empty() ? "nothing: there is nothing to set" : join_choices(names);
  }

  // Whether no optional section around a key has been left out.
  bool has_defaults(const std::string& path) const {
    const SectionInfo* section = schema_.find_section(path);
    if (section == nullptr) return true;
    if (section->optional && !places.contains(path)) return false;
    return has_defaults(section->parent());
  }

  [[noreturn]] void unknown(const std::string& path, const ConfigEntry& entry) const {
    std::string hint = did_you_mean(entry.key, schema_.names_in(path));
    if (hint.empty()) hint = elsewhere(entry.key);
    const char* kind = path == "stages" ? "unknown stage " : "unknown key ";
    throw ConfigError({entry.where,
                       kind + quote_text(entry.key) + (path.empty() ? "" : " in section " + quote_text(path)),
                       {},
                       names_in(path),
                       hint});
  }

  // A key that was put into the wrong section.
  std::string elsewhere(const std::string& name) const {
    for (const KeyInfo& key : schema_.keys)
      if (key.name == name) return "There is " + quote_text(key.path()) + '.';
    for (const SectionInfo& s : schema_.sections)
      if (s.name() == name) return "There is " + quote_text(s.path) + '.';
    return {};
  }

  const Schema& schema_;
};

}  // namespace

ConfigNode read_with_overrides(const std::string& file, const std::vector<std::string>& overrides,
                               const Schema& schema) {
  ConfigNode root = read_config(file);
  if (root.kind == ConfigNode::Kind::mapping)
    for (const std::string& text : overrides) apply_override(root, text, schema);
  const Validation validation(schema);
  validation.check_version(root, file);
  validation.check_kind(root);
  return root;
}

CheckedConfig check_config(const ConfigNode& root, const std::string& file, const Schema& schema) {
  Validation validation(schema);
  validation.section("", {file, 0}, root);
  validation.add_defaults();
  return {std::move(validation.values), std::move(validation.places)};
}

CheckedConfig load_config(const std::string& file, const std::vector<std::string>& overrides, const Schema& schema) {
  return check_config(read_with_overrides(file, overrides, schema), file, schema);
}

}  // namespace grainvdb
