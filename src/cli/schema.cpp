#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "grainvdb/pipeline.hpp"
#include "spot/spot_schema.hpp"

namespace grainvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema_footer = R"(Examples:
  grainvdb schema > grainvdb.schema.json
  grainvdb schema --text
  grainvdb schema --spot --text

Editors check pipeline files against the schema when it is named in their first line:
  # yaml-language-server: $schema=grainvdb.schema.json)";

std::string type_text(const Json& value);

std::string joined(const Json& parts, const char* between, std::string (*text)(const Json&)) {
  std::string result;
  for (const Json& part : parts) result += (result.empty() ? "" : between) + text(part);
  return result;
}

// What a value may be, from its part of the schema.
std::string type_text(const Json& value) {
  if (value.contains("title")) return value["title"].get<std::string>();
  if (value.contains("const")) return value["const"].get<std::string>();
  if (value.contains("enum"))
    return joined(value["enum"], " | ", [](const Json& name) { return name.get<std::string>(); });
  if (value.contains("anyOf")) {
    const Json& first = value["anyOf"][0];
    // Where a list is wanted, one text may stand for a list of one.
    if (first.contains("items") && first["items"] == value["anyOf"][1]) return type_text(first);
    return joined(value["anyOf"], " or ", &type_text);
  }
  if (value.contains("properties")) {
    std::string keys;
    for (const auto& [name, inside] : value["properties"].items())
      keys += (keys.empty() ? "" : ", ") + name + ": " + type_text(inside);
    return '{' + keys + '}';
  }
  if (value.contains("additionalProperties") && value["additionalProperties"].is_object())
    return "{NAME: " + type_text(value["additionalProperties"]) + ", ...}";
  const auto type = value.value("type", std::string());
  return type == "array" ? "list of " + type_text(value["items"]) : type;
}

void print_section(const Json& section, const std::string& indent) {
  const Json required = section.value("required", Json::array());
  for (const auto& [name, value] : section["properties"].items()) {
    const bool is_required = std::find(required.begin(), required.end(), name) != required.end();
    std::cout << indent << name << ':';
    if (value.contains("properties")) {
      std::cout << (is_required ? "  (required)" : "") << "  # " << value["description"].get<std::string>() << '\n';
      print_section(value, indent + "  ");
      continue;
    }
    std::cout << ' ' << type_text(value);
    if (is_required) std::cout << "  (required)";
    if (value.contains("default")) std::cout << "  (default " << value["default"].dump() << ')';
    std::cout << "\n" << indent << "    " << value["description"].get<std::string>() << '\n';
  }
}

}  // namespace

void add_schema(CLI::App& app) {
  CLI::App* command = app.add_subcommand("schema", "Print the schema of pipeline files, as JSON Schema (draft 7)");
  const auto text = std::make_shared<bool>(false), spot = std::make_shared<bool>(false);
  command->add_flag("--text", *text, "Print every key with its type, default and help instead");
  command->add_flag("--spot", *spot, "The schema of spot files, which 'grainvdb spot run' takes");
  command->footer(schema_footer);
  command->callback([text, spot] {
    const std::string schema = *spot ? spot::spot_file_schema() : pipeline_schema();
    if (*text)
      print_section(Json::parse(schema), "");
    else
      std::cout << schema;
  });
}

}  // namespace grainvdb::cli
