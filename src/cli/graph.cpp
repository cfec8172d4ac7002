#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* footer = R"(Examples:
  grainvdb graph pipelines/shear_cell.yaml
  grainvdb graph pipelines/shear_cell.yaml --set output.fields=[phi]
  grainvdb graph pipelines/shear_cell.yaml --dot | dot -Tsvg > graph.svg

The dumps are not opened.)";

struct Options {
  PipelineArguments pipeline;
  bool dot = false;
};

}  // namespace

void add_graph(CLI::App& app) {
  CLI::App* command = app.add_subcommand("graph", "Show what a pipeline would read, compute and write");
  const auto options = std::make_shared<Options>();
  add_pipeline_arguments(*command, options->pipeline);
  command->add_flag("--dot", options->dot, "Print a Graphviz digraph");
  command->footer(footer);
  command->callback([options] {
    const Pipeline pipeline = load_pipeline(options->pipeline.file, options->pipeline.overrides);
    const Plan plan = make_plan(pipeline);
    std::cout << (options->dot ? describe_dot(plan, pipeline) : describe(plan, pipeline));
  });
}

}  // namespace grainvdb::cli
