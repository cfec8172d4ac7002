#include "cli/listing.hpp"

#include <cmath>
#include <iostream>
#include <variant>
#include <vector>

#include "base/listed.hpp"
#include "grainvdb/error.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::cli {

std::shared_ptr<ListRequest> add_list_options(CLI::App& command, const std::string& what) {
  const auto request = std::make_shared<ListRequest>();
  command.add_option("name", request->name, "One " + what + " to show in full")->type_name("NAME");
  CLI::Option* json = command.add_flag("--json", request->json, "Print as JSON");
  command.add_flag("--markdown", request->markdown, "Print as a Markdown table")->excludes(json);
  return request;
}

void print_list(const ListRequest& request, const std::string& what, const Json& entries,
                const ListPrinters& printers) {
  Json wanted = Json::array();
  std::vector<std::string> names;
  for (const Json& entry : entries) {
    names.push_back(entry["name"]);
    if (request.name.empty() || request.name == names.back()) wanted.push_back(entry);
  }
  if (wanted.empty())
    throw ConfigError({{},
                       "there is no " + what + ' ' + quote_text(request.name),
                       {},
                       join_choices(names),
                       did_you_mean(request.name, names)});
  if (request.json)
    std::cout << wanted.dump(2) << '\n';
  else if (request.markdown)
    printers.markdown(wanted);
  else if (request.name.empty())
    printers.table(wanted);
  else
    printers.details(wanted.front());
}

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
  return names.empty() ? none : listed(names, [](const Json& name) { return name.get<std::string>(); });
}

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, 1, '\\');
  return text;
}

}  // namespace grainvdb::cli
