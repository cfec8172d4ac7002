#include <iomanip>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/describe_options.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/units.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* footer = R"(Examples:
  grainvdb stages
  grainvdb stages temperature
  grainvdb stages --markdown > fields.md
  grainvdb stages --json

Each stage makes the field of its name. Units are those of an SI run; other runs have their own.)";

struct Options {
  std::string name;
  bool json = false;
  bool markdown = false;
};

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
          {"options", options}};
}

void print_details(const Json& stage) {
  std::cout << stage["name"].get<std::string>() << ": " << stage["description"].get<std::string>() << '\n'
            << "  components  " << stage["components"] << '\n'
            << "  unit        " << stage["unit"].get<std::string>() << '\n'
            << "  equation    " << stage["equation"].get<std::string>() << '\n'
            << "  needs       " << joined(stage["needs"], "no other field") << '\n'
            << "  reads       " << joined(stage["reads"], "nothing") << " in " << stage["sweeps"]
            << (stage["sweeps"] == 1 ? " sweep" : " sweeps") << '\n';
  print_options(stage["options"]);
}

void print_table(const Json& stages) {
  std::cout << std::left;
  for (const Json& stage : stages)
    std::cout << std::setw(24) << stage["name"].get<std::string>() << ' ' << std::setw(2)
              << stage["components"].get<int>() << ' ' << std::setw(10) << stage["unit"].get<std::string>() << ' '
              << stage["equation"].get<std::string>() << '\n';
  std::cout << "\n'grainvdb stages NAME' shows one with what it needs and its options.\n";
}

void print_markdown(const Json& stages) {
  std::cout << "| field | components | unit (SI) | what | equation | needs | options (default) |\n"
            << "|---|---|---|---|---|---|---|\n";
  for (const Json& stage : stages) {
    std::cout << "| `" << stage["name"].get<std::string>() << "` | " << stage["components"] << " | "
              << cell(stage["unit"].get<std::string>()) << " | " << cell(stage["description"].get<std::string>())
              << " | " << cell(stage["equation"].get<std::string>()) << " | " << joined(stage["needs"], "-") << " | "
              << cell(options_in_short(stage["options"])) << " |\n";
  }
}

void list_stages(const Options& options) {
  const StageRegistry& registry = StageRegistry::standard();
  Json stages = Json::array();
  std::vector<std::string> names;
  for (const Stage& stage : registry.stages()) {
    names.push_back(stage.name);
    if (options.name.empty() || options.name == stage.name) stages.push_back(describe_stage(stage));
  }
  if (stages.empty())
    throw ConfigError({{},
                       "there is no stage " + quote_text(options.name),
                       {},
                       join_choices(names),
                       did_you_mean(options.name, names)});
  if (options.json)
    std::cout << stages.dump(2) << '\n';
  else if (options.markdown)
    print_markdown(stages);
  else if (options.name.empty())
    print_table(stages);
  else
    print_details(stages.front());
}

}  // namespace

void add_stages(CLI::App& app) {
  CLI::App* command = app.add_subcommand("stages", "List the fields that can be computed, with equations and options");
  const auto options = std::make_shared<Options>();
  command->add_option("name", options->name, "One stage to show in full")->type_name("NAME");
  CLI::Option* json = command->add_flag("--json", options->json, "Print as JSON");
  command->add_flag("--markdown", options->markdown, "Print as a Markdown table")->excludes(json);
  command->footer(footer);
  command->callback([options] { list_stages(*options); });
}

}  // namespace grainvdb::cli
