#include "pipeline/convert.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "pipeline/frame_range.hpp"
#include "pipeline/number.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

[[noreturn]] void refuse(const KeyInfo& key, const ConfigNode& node, const std::string& what, std::string hint = {}) {
  if (hint.empty()) hint = key.hint;
  throw ConfigError({node.where, key.path() + ' ' + what, node.kind_name(), accepted(key), hint});
}

const std::string& scalar(const KeyInfo& key, const ConfigNode& node) {
  if (node.kind == ConfigNode::Kind::null) refuse(key, node, "has no value");
  if (node.kind != ConfigNode::Kind::scalar) refuse(key, node, "must be a single value");
  return node.text;
}

// Scalars in quotes are texts.
const std::string& plain(const KeyInfo& key, const ConfigNode& node) {
  const std::string& text = scalar(key, node);
  if (node.quoted) refuse(key, node, "must not be in quotes");
  return text;
}

void check_range(const KeyInfo& key, const ConfigNode& node, double value) {
  if (std::isinf(value) && !key.infinite_allowed) refuse(key, node, "must be finite");
  if (value < key.minimum || (key.above_minimum && value == key.minimum)) refuse(key, node, "is too small");
  if (value > key.maximum) refuse(key, node, "is too large");
}

double number(const KeyInfo& key, const ConfigNode& node) {
  const auto value = parse_number(plain(key, node));
  if (!value) refuse(key, node, "is not a number");
  check_range(key, node, *value);
  return *value;
}

std::int64_t integer(const KeyInfo& key, const ConfigNode& node) {
  const auto value = parse_integer(plain(key, node));
  if (!value) refuse(key, node, "is not a whole number");
  check_range(key, node, static_cast<double>(*value));
  return *value;
}

bool boolean(const KeyInfo& key, const ConfigNode& node) {
  const std::string& text = plain(key, node);
  if (text != "true" && text != "false") refuse(key, node, "must be true or false");
  return text == "true";
}

// Beside a guess a long list is in the way.
std::string expected_names(const KeyInfo& key, const std::string& guess) {
  constexpr std::size_t most = 24;
  if (guess.empty() || key.choices.size() <= most) return join_choices(key.choices);
  return "one of " + std::to_string(key.choices.size()) + " names";
}

std::string text_value(const KeyInfo& key, const ConfigNode& node) {
  const std::string& text = scalar(key, node);
  if (text.empty()) refuse(key, node, "is empty");
  if (key.choices.empty() || std::find(key.choices.begin(), key.choices.end(), text) != key.choices.end()) return text;
  std::string hint = did_you_mean(text, key.choices);
  const std::string expected = expected_names(key, hint);
  if (!hint.empty() && !key.hint.empty()) hint += ' ';
  throw ConfigError({node.where, "unknown name in " + key.path(), quote_text(text), expected, hint + key.hint});
}

void check_count(const KeyInfo& key, const ConfigNode& node, std::size_t count) {
  if (count < key.fewest || count > key.most)
    throw ConfigError({node.where, key.path() + (count == 0 ? " is an empty list" : " has the wrong number of items"),
                       count == 0 ? "" : std::to_string(count), accepted(key), key.hint});
}

template <class T>
std::vector<T> list(const KeyInfo& key, const ConfigNode& node, T (*item)(const KeyInfo&, const ConfigNode&)) {
  if (node.kind != ConfigNode::Kind::sequence) refuse(key, node, "must be a list");
  check_count(key, node, node.items.size());
  std::vector<T> result;
  for (const ConfigNode& n : node.items) result.push_back(item(key, n));
  return result;
}

std::vector<double> numbers(const KeyInfo& key, const ConfigNode& node) {
  if (key.one_for_all && node.kind == ConfigNode::Kind::scalar) return std::vector<double>(key.most, number(key, node));
  return list<double>(key, node, &number);
}

Vec3 point(const KeyInfo& key, const ConfigNode& node) {
  if (node.kind != ConfigNode::Kind::sequence || node.items.size() != 3)
    refuse(key, node, "has an item that is no place");
  return {number(key, node.items[0]), number(key, node.items[1]), number(key, node.items[2])};
}

std::vector<std::string> texts(const KeyInfo& key, const ConfigNode& node) {
  std::vector<std::string> result;
  if (node.kind == ConfigNode::Kind::scalar) {
    result.push_back(text_value(key, node));
    check_count(key, node, 1);
  } else {
    result = list<std::string>(key, node, &text_value);
  }
  std::unordered_set<std::string> seen;
  for (std::size_t i = 0; i < result.size(); ++i)
    if (!seen.insert(result[i]).second)
      throw ConfigError({node.items[i].where, key.path() + " names " + quote_text(result[i]) + " twice", {}, {}, {}});
  return result;
}

[[noreturn]] void refuse_name(const std::string& what, const ConfigEntry& entry,
                              const std::vector<std::string>& names) {
  throw ConfigError(
      {entry.where, what + ' ' + quote_text(entry.key), {}, join_choices(names), did_you_mean(entry.key, names)});
}

/// The keys of a section of that kind.
ConfigItem section_of_kind(const KeyInfo& key, const ItemKind& kind, const ConfigEntry& entry) {
  ConfigItem result{kind.name, {}};
  const auto find = [&](const std::string& name) {
    return std::find_if(kind.keys.begin(), kind.keys.end(), [&](const KeyInfo& k) { return k.name == name; });
  };
  for (const ConfigEntry& value : entry.value.entries) {
    const auto own = find(value.key);
    if (own == kind.keys.end()) {
      std::vector<std::string> names;
      for (const KeyInfo& k : kind.keys) names.push_back(k.name);
      refuse_name("unknown key of a " + kind.name + " in " + key.path() + ':', value, names);
    }
    result.values.emplace_back(value.key, convert(*own, value.value));
  }
  for (const KeyInfo& own : kind.keys) {
    if (result.find(own.name) != nullptr) continue;
    if (own.required)
      throw ConfigError({entry.where, "the key '" + own.path() + "' is missing", {}, accepted(own), {}});
    if (own.default_value) result.values.emplace_back(own.name, *own.default_value);
  }
  return result;
}

ConfigItem item(const KeyInfo& key, const ConfigNode& node) {
  if (node.kind != ConfigNode::Kind::mapping || node.entries.size() != 1)
    refuse(key, node, "has an item that is not one section");
  const ConfigEntry& entry = node.entries.front();
  const auto kind =
      std::find_if(key.kinds.begin(), key.kinds.end(), [&](const ItemKind& k) { return k.name == entry.key; });
  if (kind == key.kinds.end()) {
    std::vector<std::string> names;
    for (const ItemKind& k : key.kinds) names.push_back(k.name);
    refuse_name("unknown kind of item in " + key.path() + ':', entry, names);
  }
  if (entry.value.kind != ConfigNode::Kind::mapping) refuse(key, node, "has an item without keys");
  return section_of_kind(key, *kind, entry);
}

std::vector<ConfigItem> named_items(const KeyInfo& key, const ConfigNode& node) {
  if (node.kind != ConfigNode::Kind::mapping || node.entries.empty()) refuse(key, node, "must hold named sections");
  std::vector<ConfigItem> result;
  for (const ConfigEntry& entry : node.entries) {
    if (entry.value.kind != ConfigNode::Kind::mapping) refuse(key, entry.value, "." + entry.key + " must be a section");
    result.push_back(section_of_kind(key, key.kinds.at(0), entry));
    result.back().kind = entry.key;
  }
  return result;
}

std::string frame_range(const KeyInfo& key, const ConfigNode& node) {
  const std::string& text = scalar(key, node);
  const auto range = parse_frame_range(text);
  if (!range) refuse(key, node, "is not a range of frames");
  const bool same_side = range->start && range->stop && (*range->start < 0) == (*range->stop < 0);
  if ((same_side && *range->start >= *range->stop) || range->stop == 0) refuse(key, node, "selects no frame");
  return text;
}

ConfigValue window(const KeyInfo& key, const ConfigNode& node) {
  const std::string& text = scalar(key, node);
  if (text == "all" || text == "none") return text;
  if (!parse_integer(text)) refuse(key, node, "is not a number of frames", did_you_mean(text, {"all", "none"}));
  return integer(key, node);
}

}  // namespace

ConfigValue convert(const KeyInfo& key, const ConfigNode& node) {
  switch (key.type) {
    case ValueType::boolean:
      return boolean(key, node);
    case ValueType::integer:
      return integer(key, node);
    case ValueType::number:
      return number(key, node);
    case ValueType::text:
      return text_value(key, node);
    case ValueType::texts:
      return texts(key, node);
    case ValueType::integers:
      return list<std::int64_t>(key, node, &integer);
    case ValueType::numbers:
      return numbers(key, node);
    case ValueType::points:
      return list<Vec3>(key, node, &point);
    case ValueType::items:
      return list<ConfigItem>(key, node, &item);
    case ValueType::named_items:
      return named_items(key, node);
    case ValueType::frame_range:
      return frame_range(key, node);
    case ValueType::window:
      break;
  }
  return window(key, node);
}

}  // namespace grainvdb
