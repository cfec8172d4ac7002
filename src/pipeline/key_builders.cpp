#include "pipeline/key_builders.hpp"

#include <filesystem>
#include <utility>
#include <variant>

namespace grainvdb {
namespace {

// The folder of the pipeline file as the beginning of a pattern: its own name has no wildcards.
std::string without_wildcards(const std::string& folder) {
  std::string escaped;
  for (char c : folder) {
    if (c == '*' || c == '?' || c == '[' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

KeyInfo number_key(std::string section, std::string name, std::string unit, std::string help, ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::number, std::move(help), std::move(unit)};
  key.minimum = 0;
  key.above_minimum = true;
  key.hint = no_unit_hint;
  key.apply = std::move(apply);
  return key;
}

KeyInfo texts_key(std::string section, std::string name, std::string help, std::vector<std::string> choices,
                  ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::texts, std::move(help)};
  key.choices = std::move(choices);
  key.apply = std::move(apply);
  return key;
}

std::vector<std::string> paths_beside(const std::string& file, const std::vector<std::string>& paths) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const std::filesystem::path folder_of_pattern = without_wildcards(folder.string());
  std::vector<std::string> result;
  for (const std::string& path : paths) {
    const bool is_pattern = path.find_first_of("*?[") != std::string::npos;
    result.push_back(((is_pattern ? folder_of_pattern : folder) / path).string());
  }
  return result;
}

std::vector<std::string> input_paths(const Pipeline& pipeline, const ConfigValue& value) {
  return paths_beside(pipeline.file, std::get<std::vector<std::string>>(value));
}

KeyInfo vector_key(std::string section, std::string name, std::string help, ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::numbers, std::move(help), "length"};
  key.fewest = key.most = 3;
  key.hint = no_unit_hint;
  key.apply = std::move(apply);
  return key;
}

void add_box_keys(Schema& schema, const std::string& section, const BoxOf& corners) {
  const auto add = [&](const char* name, const char* help, Vec3 std::pair<Vec3, Vec3>::*corner) {
    auto key = vector_key(section, name, help, [corners, corner](Pipeline& p, const ConfigValue& v) {
      auto& box = corners(p);
      if (!box) box.emplace();
      (*box).*corner = vector_of(v);
    });
    key.required = true;
    key.infinite_allowed = true;
    schema.keys.push_back(key);
  };
  add("lo", "Lower corner.", &std::pair<Vec3, Vec3>::first);
  add("hi", "Upper corner.", &std::pair<Vec3, Vec3>::second);
}

Vec3 vector_of(const ConfigValue& value) {
  const auto& v = std::get<std::vector<double>>(value);
  return {v.at(0), v.at(1), v.at(2)};
}

}  // namespace grainvdb
