#include <nlohmann/json.hpp>

#include "grainvdb/pipeline.hpp"
#include "pipeline/schema.hpp"

namespace grainvdb {
namespace {

using Json = nlohmann::ordered_json;

Json number_schema(const KeyInfo& key, const char* type) {
  Json json{{"type", type}};
  if (std::isfinite(key.minimum)) json[key.above_minimum ? "exclusiveMinimum" : "minimum"] = key.minimum;
  if (std::isfinite(key.maximum)) json["maximum"] = key.maximum;
  return json;
}

Json text_schema(const KeyInfo& key) {
  Json json{{"type", "string"}, {"minLength", 1}};
  if (key.choices.empty()) return json;
  if (!key.name_pattern.empty()) {
    const Json elsewhere{{"title", "FIELD_SPECIES"}, {"pattern", key.name_pattern}};
    return {{"type", "string"}, {"anyOf", {{{"enum", key.choices}}, elsewhere}}};
  }
  json["enum"] = key.choices;
  return json;
}

Json list_schema(const KeyInfo& key, const Json& items) {
  Json json{{"type", "array"}, {"items", items}, {"minItems", key.fewest}};
  if (key.most < std::numeric_limits<std::size_t>::max()) json["maxItems"] = key.most;
  return json;
}

Json key_schema(const KeyInfo& key);

Json inside_of_kind(const ItemKind& kind) {
  Json properties = Json::object(), required = Json::array();
  for (const KeyInfo& key : kind.keys) {
    properties[key.name] = key_schema(key);
    if (key.required) required.push_back(key.name);
  }
  return {{"type", "object"},
          {"description", kind.help},
          {"properties", properties},
          {"required", required},
          {"additionalProperties", false}};
}

/// A section that holds the one kind of item.
Json kind_schema(const ItemKind& kind) {
  return {{"type", "object"},
          {"properties", {{kind.name, inside_of_kind(kind)}}},
          {"required", Json::array({kind.name})},
          {"additionalProperties", false}};
}

Json default_of(const std::vector<ConfigItem>&) {
  return Json::array();
}
template <class T>
Json default_of(const T& value) {
  return value;
}

Json value_schema(const KeyInfo& key) {
  switch (key.type) {
    case ValueType::boolean:
      return {{"type", "boolean"}};
    case ValueType::integer:
      return number_schema(key, "integer");
    case ValueType::number:
      return number_schema(key, "number");
    case ValueType::text:
      return text_schema(key);
    case ValueType::integers:
      return list_schema(key, number_schema(key, "integer"));
    case ValueType::numbers: {
      const Json list = list_schema(key, number_schema(key, "number"));
      return key.one_for_all ? Json{{"anyOf", {list, number_schema(key, "number")}}} : list;
    }
    case ValueType::points: {
      const Json place{{"type", "array"}, {"items", number_schema(key, "number")}, {"minItems", 3}, {"maxItems", 3}};
      return list_schema(key, place);
    }
    case ValueType::texts: {
      Json list = list_schema(key, text_schema(key));
      list["uniqueItems"] = true;
      return key.fewest > 1 ? list : Json{{"anyOf", {list, text_schema(key)}}};
    }
    case ValueType::items: {
      Json kinds = Json::array();
      for (const ItemKind& kind : key.kinds) kinds.push_back(kind_schema(kind));
      return list_schema(key, {{"anyOf", kinds}});
    }
    case ValueType::named_items:
      return {{"type", "object"},
              {"minProperties", 1},
              {"propertyNames", {{"pattern", '^' + key.name_pattern + '$'}}},
              {"additionalProperties", inside_of_kind(key.kinds.at(0))}};
    case ValueType::frame_range:
      return {{"anyOf",
               {{{"type", "string"}, {"pattern", "^([-+]?[0-9]+|[-+]?[0-9]*:[-+]?[0-9]*(:[0-9]*)?)$"}},
                {{"type", "integer"}}}}};
    case ValueType::window:
      break;
  }
  return {{"anyOf", {{{"enum", {"all", "none"}}}, number_schema(key, "integer")}}};
}

Json key_schema(const KeyInfo& key) {
  Json json = value_schema(key);
  json["description"] = key.help + (key.unit.empty() ? "" : " [" + key.unit + ']');
  if (key.default_value) json["default"] = std::visit([](const auto& v) { return default_of(v); }, *key.default_value);
  return json;
}

Json section_schema(const Schema& schema, const std::string& path, const std::string& help) {
  Json properties = Json::object(), required = Json::array();
  for (const KeyInfo& key : schema.keys) {
    if (key.section != path) continue;
    properties[key.name] = key_schema(key);
    if (key.required) required.push_back(key.name);
  }
  for (const SectionInfo& child : schema.sections) {
    if (child.parent() != path) continue;
    properties[child.name()] = section_schema(schema, child.path, child.help);
    if (child.required) required.push_back(child.name());
  }
  Json json{{"type", "object"}, {"description", help}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) json["required"] = required;
  return json;
}

}  // namespace

std::string json_schema(const Schema& schema, const std::string& title, const std::string& help) {
  Json json{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  json.update(section_schema(schema, "", help));
  return json.dump(2) + '\n';
}

std::string pipeline_schema(const StageRegistry& registry) {
  return json_schema(make_schema(registry), "grainvdb pipeline file",
                     "What to read, on which lattice, and which fields to write.");
}

}  // namespace grainvdb
