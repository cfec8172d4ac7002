#include <iomanip>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/listing.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* stages_footer = R"(Examples:
  grainvdb stages
  grainvdb stages temperature
  grainvdb stages --markdown > fields.md
  grainvdb stages --json

Each stage makes the field of its name. Units are those of an SI run; other runs have their own.)";

// What asking for the field alone comes to, with all options at their defaults.
Plan plan_for(const Stage& stage) {
  Pipeline pipeline;
  pipeline.fields = {stage.name};
  pipeline.voxel = 1;
  pipeline.cutoff = 6;  // wide enough for any stage
  pipeline.stages = StageRegistry::standard().default_settings();
  return make_plan(pipeline);
}

Json describe_stage(const Stage& stage) {
  const Plan plan = plan_for(stage);
  ColumnSet columns;
  for (const Sweep& sweep : plan.sweeps) columns |= sweep.columns;
  Json needs = Json::array();
  for (const Stage* other : plan.stages)
    if (other != &stage) needs.push_back(other->name);
  Json options = Json::array();
  for (const OptionInfo& option : stage.options) options.push_back(describe_option(option));
  return {{"name", stage.name},
          {"components", stage.components},
          {"unit", find_unit_system("si")->symbol(stage.dimension)},
          {"description", stage.description},
          {"equation", stage.equation},
          {"needs", needs},
          {"reads", column_names(columns)},
          {"sweeps", plan.sweeps.size()},
          {"by_species", stage.by_species},
          {"options", options}};
}

void print_stage(const Json& stage) {
  std::cout << stage["name"].get<std::string>() << ": " << stage["description"].get<std::string>() << '\n'
            << "  components  " << stage["components"] << '\n'
            << "  unit        " << stage["unit"].get<std::string>() << '\n'
            << "  equation    " << stage["equation"].get<std::string>() << '\n'
            << "  needs       " << joined(stage["needs"], "no other field") << '\n'
            << "  reads       " << joined(stage["reads"], "nothing") << " in " << stage["sweeps"]
            << (stage["sweeps"] == 1 ? " sweep" : " sweeps") << '\n';
  if (stage["by_species"])
    std::cout << "  species     of each as well, as " << stage["name"].get<std::string>() << "_NAME\n";
  print_options(stage["options"]);
}

void print_stages(const Json& stages) {
  std::cout << std::left;
  for (const Json& stage : stages)
    std::cout << std::setw(24) << stage["name"].get<std::string>() << ' ' << std::setw(2)
              << stage["components"].get<int>() << ' ' << std::setw(10) << stage["unit"].get<std::string>() << ' '
              << stage["equation"].get<std::string>() << '\n';
  std::cout << "\n'grainvdb stages NAME' shows one with what it needs and its options.\n";
}

void print_fields_page(const Json& stages) {
  std::cout << "| field | components | unit (SI) | what | equation | needs | options (default) |\n"
            << "|---|---|---|---|---|---|---|\n";
  for (const Json& stage : stages) {
    std::cout << "| `" << stage["name"].get<std::string>() << "` | " << stage["components"] << " | "
              << cell(stage["unit"].get<std::string>()) << " | " << cell(stage["description"].get<std::string>())
              << " | " << cell(stage["equation"].get<std::string>()) << " | " << joined(stage["needs"], "-") << " | "
              << cell(options_in_short(stage["options"])) << " |\n";
  }
}

void list_stages(const ListRequest& request) {
  Json all = Json::array();
  for (const Stage& stage : StageRegistry::standard().stages()) all.push_back(describe_stage(stage));
  print_list(request, "stage", all, {print_stages, print_fields_page, print_stage});
}

}  // namespace

void add_stages(CLI::App& app) {
  CLI::App* command = app.add_subcommand("stages", "List the fields that can be computed, with equations and options");
  const auto request = add_list_options(*command, "stage");
  command->footer(stages_footer);
  command->callback([request] { list_stages(*request); });
}

}  // namespace grainvdb::cli
