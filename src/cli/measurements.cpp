#include <algorithm>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/describe_options.hpp"
#include "grainvdb/error.hpp"
#include "grainvdb/measurement.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* footer = R"(Examples:
  grainvdb measurements
  grainvdb measurements pair_correlation
  grainvdb measurements --markdown
  grainvdb measurements --json

Each stands in the section 'measure' of a pipeline file under its name, with its options.)";

struct Options {
  std::string name;
  bool json = false;
  bool markdown = false;
};

Json describe(const MeasurementInfo& info) {
  OptionValues defaults;
  Json options = Json::array();
  for (const OptionInfo& option : info.options) {
    defaults.emplace(option.name, option.default_value);
    options.push_back(describe_option(option));
  }
  const MeasurementNeeds needs = info.needs(defaults);
  return {
      {"name", info.name},         {"description", info.description},
      {"equation", info.equation}, {"reads", needs.particles ? Json(column_names(*needs.particles)) : Json::array()},
      {"fields", needs.fields},    {"options", options}};
}

void print_details(const Json& measurement) {
  std::cout << measurement["name"].get<std::string>() << ": " << measurement["description"].get<std::string>() << '\n'
            << "  equation    " << measurement["equation"].get<std::string>() << '\n'
            << "  reads       " << joined(measurement["reads"], "no frames") << '\n'
            << "  fields      " << joined(measurement["fields"], "none") << '\n';
  print_options(measurement["options"]);
}

void print_table(const Json& measurements) {
  for (const Json& m : measurements) {
    std::string name = m["name"];
    name.resize(std::max<std::size_t>(name.size() + 1, 24), ' ');
    std::cout << name << m["description"].get<std::string>() << '\n';
  }
  std::cout << "\n'grainvdb measurements NAME' shows one with its equation, what it needs and its options.\n";
}

void print_markdown(const Json& measurements) {
  std::cout << "| measurement | what | equation | reads | fields | options (default) |\n|---|---|---|---|---|---|\n";
  for (const Json& m : measurements)
    std::cout << "| `" << m["name"].get<std::string>() << "` | " << cell(m["description"]) << " | "
              << cell(m["equation"]) << " | " << joined(m["reads"], "-") << " | " << joined(m["fields"], "-") << " | "
              << cell(options_in_short(m["options"])) << " |\n";
}

void list(const Options& options) {
  Json measurements = Json::array();
  std::vector<std::string> names;
  for (const MeasurementInfo& info : measurement_registry()) {
    names.push_back(info.name);
    if (options.name.empty() || options.name == info.name) measurements.push_back(describe(info));
  }
  if (measurements.empty())
    throw ConfigError({{},
                       "there is no measurement " + quote_text(options.name),
                       {},
                       join_choices(names),
                       did_you_mean(options.name, names)});
  if (options.json)
    std::cout << measurements.dump(2) << '\n';
  else if (options.markdown)
    print_markdown(measurements);
  else if (options.name.empty())
    print_table(measurements);
  else
    print_details(measurements.front());
}

}  // namespace

void add_measurements(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("measurements", "List the tables that can be made, with equations and options");
  const auto options = std::make_shared<Options>();
  command->add_option("name", options->name, "One measurement to show in full")->type_name("NAME");
  CLI::Option* json = command->add_flag("--json", options->json, "Print as JSON");
  command->add_flag("--markdown", options->markdown, "Print as a Markdown table")->excludes(json);
  command->footer(footer);
  command->callback([options] { list(*options); });
}

}  // namespace grainvdb::cli
