#include "cli/describe_options.hpp"

#include <cmath>
#include <iostream>
#include <variant>

namespace grainvdb::cli {

Json describe_option(const OptionInfo& option) {
  static constexpr const char* types[] = {"boolean", "integer", "number", "text", "list of texts", "list of numbers"};
  Json json{{"name", option.name},
            {"type", types[option.default_value.index()]},
            {"default", std::visit([](const auto& v) { return Json(v); }, option.default_value)},
            {"help", option.help}};
  if (!option.choices.empty()) json["choices"] = option.choices;
  if (std::isfinite(option.minimum)) json["minimum"] = option.minimum;
  if (std::isfinite(option.maximum)) json["maximum"] = option.maximum;
  return json;
}

void print_options(const Json& options) {
  for (const Json& option : options) {
    std::cout << "  option " << option["name"].get<std::string>() << " (" << option["type"].get<std::string>()
              << ", default " << option["default"].dump() << ")\n      " << option["help"].get<std::string>() << '\n';
    if (option.contains("choices")) std::cout << "      one of " << joined(option["choices"], "") << '\n';
    if (option.contains("minimum")) std::cout << "      at least " << option["minimum"] << '\n';
    if (option.contains("maximum")) std::cout << "      at most " << option["maximum"] << '\n';
  }
}

std::string options_in_short(const Json& options) {
  std::string text;
  for (const Json& option : options)
    text += (text.empty() ? "`" : ", `") + option["name"].get<std::string>() + "` (" + option["default"].dump() + ')';
  return text.empty() ? "-" : text;
}

std::string joined(const Json& names, const char* none) {
  std::string text;
  for (const Json& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text.empty() ? none : text;
}

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, 1, '\\');
  return text;
}

}  // namespace grainvdb::cli
