#include "pipeline/resolved.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "base/listed.hpp"
#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

// Names stand plain; everything else is a JSON text, which is a YAML text too.
std::string print(const std::string& text) {
  static const std::vector<std::string> reserved{"true", "false", "null", "yes", "no", "on", "off", "y", "n"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const bool is_name = !text.empty() && is_letter(text.front()) && std::all_of(text.begin(), text.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9');
  });
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  if (is_name && std::find(reserved.begin(), reserved.end(), lower) == reserved.end()) return text;
  return nlohmann::json(text).dump();
}
std::string print(bool value) {
  return value ? "true" : "false";
}
std::string print(std::int64_t value) {
  return std::to_string(value);
}
std::string print(double value) {
  return print_number(value);
}
std::string print(const ConfigItem& item);
std::string print(const Vec3& place) {
  return '[' + print(place[0]) + ", " + print(place[1]) + ", " + print(place[2]) + ']';
}
template <class T>
std::string print(const std::vector<T>& items) {
  return '[' + listed(items, [](const T& item) { return print(item); }) + ']';
}

std::string print_entry(const ConfigItem& item) {
  const auto print_key = [](const auto& key) {
    return key.first + ": " + std::visit([](const auto& v) { return print(v); }, key.second);
  };
  return print(item.kind) + ": {" + listed(item.values, print_key) + '}';
}

std::string print(const ConfigItem& item) {
  return '{' + print_entry(item) + '}';
}

std::string print_named(const ConfigValue& value) {
  return '{' + listed(std::get<std::vector<ConfigItem>>(value), &print_entry) + '}';
}

std::string print_value(const KeyInfo& key, const ConfigValue& value) {
  if (key.type == ValueType::named_items) return print_named(value);
  return std::visit([](const auto& v) { return print(v); }, value);
}

void print_section(const Schema& schema, const std::map<std::string, ConfigValue>& values, const std::string& section,
                   const std::string& indent, std::string& out) {
  for (const KeyInfo& key : schema.keys)
    if (const auto it = values.find(key.path()); key.section == section && it != values.end())
      out += indent + key.name + ": " + print_value(key, it->second) + '\n';
  for (const SectionInfo& child : schema.sections) {
    if (child.parent() != section) continue;
    std::string inside;
    print_section(schema, values, child.path, indent + "  ", inside);
    if (!inside.empty()) out += indent + child.name() + ":\n" + inside;
  }
}

}  // namespace

std::string resolved_yaml(const Schema& schema, const std::map<std::string, ConfigValue>& values) {
  std::string text;
  print_section(schema, values, "", "", text);
  return text;
}

}  // namespace grainvdb
