#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/report.hpp"
#include "grainvdb/memory_model.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/scales.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* graph_footer = R"(Examples:
  grainvdb graph pipelines/shear_cell.yaml
  grainvdb graph pipelines/shear_cell.yaml --set output.fields=[phi]
  grainvdb graph pipelines/shear_cell.yaml --dot | dot -Tsvg > graph.svg

The dumps are not opened.)";

struct GraphOptions {
  PipelineArguments pipeline;
  bool dot = false;
};

// The digraph of stages is the same at each scale.
void print_graph(const GraphOptions& options) {
  const std::vector<Pipeline> pipelines = at_scales(load_pipeline(options.pipeline.file, options.pipeline.settings()));
  std::vector<Plan> plans;
  for (const Pipeline& pipeline : pipelines) plans.push_back(make_plan(pipeline));
  if (options.dot) {
    std::cout << describe_dot(plans.front(), pipelines.front());
    return;
  }
  for (std::size_t n = 0; n < pipelines.size(); ++n) {
    if (pipelines.size() > 1) std::cout << (n > 0 ? "\n" : "") << scale_name(pipelines[n]) << '\n';
    std::cout << describe(plans[n], pipelines[n]);
  }
  if (pipelines.size() > 1)
    std::cout << "\npeak memory of all scales together: "
              << to_string_of_all(memory_model(plans.front(), pipelines.front()), pipelines.size()) << '\n';
}

}  // namespace

void add_graph(CLI::App& app) {
  CLI::App* command = app.add_subcommand("graph", "Show what a pipeline would read, compute and write");
  const auto options = std::make_shared<GraphOptions>();
  add_pipeline_arguments(*command, options->pipeline);
  command->add_flag("--dot", options->dot, "Print a Graphviz digraph");
  command->footer(graph_footer);
  command->callback([options] { print_graph(*options); });
}

}  // namespace grainvdb::cli
