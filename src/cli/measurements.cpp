#include <algorithm>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/listing.hpp"
#include "grainvdb/measurement.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* measurements_footer = R"(Examples:
  grainvdb measurements
  grainvdb measurements pair_correlation
  grainvdb measurements --markdown
  grainvdb measurements --json

Each stands in the section 'measure' of a pipeline file under its name, with its options.)";

Json describe(const MeasurementInfo& info) {
  OptionValues defaults;
  Json options = Json::array();
  for (const OptionInfo& option : info.options) {
    defaults.emplace(option.name, option.default_value);
    options.push_back(describe_option(option));
  }
  const MeasurementNeeds needs = info.needs(defaults);
  return {{"name", info.name},
          {"description", info.description},
          {"equation", info.equation},
          {"reads", needs.particles ? Json(column_names(*needs.particles)) : Json::array()},
          {"fields", needs.planes ? needs.planes->fields : needs.fields},
          {"options", options}};
}

void print_measurement(const Json& measurement) {
  std::cout << measurement["name"].get<std::string>() << ": " << measurement["description"].get<std::string>() << '\n'
            << "  equation    " << measurement["equation"].get<std::string>() << '\n'
            << "  reads       " << joined(measurement["reads"], "no frames") << '\n'
            << "  fields      " << joined(measurement["fields"], "none") << '\n';
  print_options(measurement["options"]);
}

void print_measurements(const Json& measurements) {
  for (const Json& m : measurements) {
    std::string name = m["name"];
    name.resize(std::max<std::size_t>(name.size() + 1, 24), ' ');
    std::cout << name << m["description"].get<std::string>() << '\n';
  }
  std::cout << "\n'grainvdb measurements NAME' shows one with its equation, what it needs and its options.\n";
}

void print_page(const Json& measurements) {
  std::cout << "| measurement | what | equation | reads | fields | options (default) |\n|---|---|---|---|---|---|\n";
  for (const Json& m : measurements)
    std::cout << "| `" << m["name"].get<std::string>() << "` | " << cell(m["description"]) << " | "
              << cell(m["equation"]) << " | " << joined(m["reads"], "-") << " | " << joined(m["fields"], "-") << " | "
              << cell(options_in_short(m["options"])) << " |\n";
}

void list(const ListRequest& request) {
  Json all = Json::array();
  for (const MeasurementInfo& info : measurement_registry()) all.push_back(describe(info));
  print_list(request, "measurement", all, {print_measurements, print_page, print_measurement});
}

}  // namespace

void add_measurements(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("measurements", "List the tables that can be made, with equations and options");
  const auto request = add_list_options(*command, "measurement");
  command->footer(measurements_footer);
  command->callback([request] { list(*request); });
}

}  // namespace grainvdb::cli
