#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/pipeline.hpp"
#include "pipeline/config_node.hpp"
#include "pipeline/convert.hpp"
#include "pipeline/resolved.hpp"
#include "pipeline/schema.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

// Puts the value of an override in its place in the tree.
void apply_override(ConfigNode& root, const std::string& text, const Schema& schema) {
  const Location where{"--set " + text, 0};
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigError({where, "an override must have the form key=value", {}, "e.g. kernel.cutoff=2.4e-3", {}});
  ConfigNode* node = &root;
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

  std::map<std::string, ConfigValue> values;
  std::map<std::string, Location> places;

 private:
  std::string names_in(const std::string& path) const {
    const auto names = schema_.names_in(path);
    return names.empty() ? "nothing: there is nothing to set" : join_choices(names);
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

void check_box(const Pipeline& p, const std::string& section, const std::optional<std::pair<Vec3, Vec3>>& box) {
  if (!box) return;
  for (std::size_t a = 0; a < 3; ++a)
    if (!(box->first[a] < box->second[a]))
      throw ConfigError({p.location(section), section + " selects nothing along " + "xyz" [a], {}, "lo < hi", {}});
}

// What no single key can tell.
void check_together(const Pipeline& p) {
  const auto& contacts = p.input.contacts;
  if (!contacts.compute.empty() && !contacts.columns.empty())
    throw ConfigError({p.location("input.contacts"),
                       "the columns of the contact dumps are described twice",
                       {},
                       "either input.contacts.compute or input.contacts.columns",
                       {}});
  const auto has = [&](const char* name) { return contacts.columns.contains(name); };
  const bool parts = has("normal_force") && has("tangential_force"),
             one_part = has("normal_force") || has("tangential_force");
  if (!contacts.columns.empty() && (has("force") ? one_part : !parts))
    throw ConfigError({p.location("input.contacts.columns"),
                       "the contact force must be given in one way",
                       {},
                       "either force (the total), or both normal_force and tangential_force",
                       {}});
  if (p.window_step > 0 && p.window == 0)
    throw ConfigError({p.location("average.step"), "average.step has no meaning for one mean of all frames",
                       "average.step " + std::to_string(p.window_step) + " at average.window all",
                       "average.window: none, or a number of frames",
                       "frames: ::" + std::to_string(p.window_step) + " averages every so many frames"});
  if (const auto& ids = p.select.ids; ids && ids->first > ids->second)
    throw ConfigError({p.location("select.ids"),
                       "select.ids selects nothing",
                       '[' + std::to_string(ids->first) + ", " + std::to_string(ids->second) + ']',
                       "the first id, then the last",
                       {}});
  check_box(p, "select.region", p.select.region);
  check_box(p, "region", p.region);
}

}  // namespace

Location Pipeline::location(const std::string& key) const {
  const auto it = where.find(key);
  return it == where.end() ? Location{file, 0} : it->second;
}

Pipeline load_pipeline(const std::string& file, const std::vector<std::string>& overrides,
                       const StageRegistry& registry) {
  const Schema schema = make_schema(registry);
  ConfigNode root = read_config(file);
  Validation validation(schema);
  if (root.kind == ConfigNode::Kind::mapping)
    for (const std::string& text : overrides) apply_override(root, text, schema);
  validation.check_version(root, file);
  validation.section("", {file, 0}, root);
  for (const KeyInfo& key : schema.keys)
    if (key.default_value) validation.values.emplace(key.path(), *key.default_value);

  Pipeline pipeline;
  pipeline.file = file;
  pipeline.stages = registry.default_settings();
  for (const KeyInfo& key : schema.keys)
    if (const auto it = validation.values.find(key.path()); it != validation.values.end())
      key.apply(pipeline, it->second);
  pipeline.where = validation.places;
  for (const auto& [key, place] : pipeline.where)
    if (key.starts_with("input.")) pipeline.input.where.emplace(key, place);
  check_together(pipeline);
  pipeline.resolved = resolved_yaml(schema, validation.values);
  return pipeline;
}

}  // namespace grainvdb
