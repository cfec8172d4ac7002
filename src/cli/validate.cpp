#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/error_json.hpp"
#include "cli/open_input.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/scales.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* validate_footer = R"(Examples:
  grainvdb validate pipelines/shear_cell.yaml
  grainvdb validate pipelines/shear_cell.yaml --no-input --set kernel.cutoff=3e-3
  grainvdb validate pipelines/shear_cell.yaml --json

Prints 'valid' and exits with 0 only when the pipeline can be run. The first selected frame is read and checked as
the run will; later frames are not. With --json, what is wrong is printed to the standard output by its parts: kind,
exit_code, file, line, what, found, expected, hint, message; those that do not apply are left out.)";

struct ValidateOptions {
  PipelineArguments pipeline;
  bool no_input = false;
  bool json = false;
};

// The first frame that the run will use.
void check_first_frame(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source) {
  const std::vector<std::size_t> frames = select_frames(pipeline.frames, source.frames().size());
  for (const std::size_t k : frames) {
    try {
      return check_frame(pipeline, plan, lattice, source, k);
    } catch (const InputError&) {
      if (pipeline.input.on_error == OnError::error || k == frames.back()) throw;
    }
  }
}

void check(const ValidateOptions& options) {
  const std::vector<Pipeline> pipelines = at_scales(load_pipeline(options.pipeline.file, options.pipeline.settings()));
  std::vector<Plan> plans;
  for (const Pipeline& pipeline : pipelines) plans.push_back(make_plan(pipeline));
  if (options.no_input) return;
  const auto source = open_input(pipelines.front(), plans.front());
  for (std::size_t n = 0; n < pipelines.size(); ++n) {
    if (!pipelines[n].measure.empty()) check_measure_against_input(pipelines[n], *source);
    if (plans[n].stages.empty()) continue;
    const Lattice lattice = check_against_input(pipelines[n], plans[n], *source);
    check_trace_against_input(pipelines[n], *source);
    check_first_frame(pipelines[n], plans[n], lattice, *source);
  }
}

void print(const nlohmann::ordered_json& json) {
  // Files may hold any bytes; JSON is UTF-8.
  std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void validate(const ValidateOptions& options) {
  if (!options.json) {
    check(options);
    std::cout << "valid\n";
    return;
  }
  try {
    check(options);
    print({{"valid", true}});
  } catch (const Error& error) {
    print({{"valid", false}, {"error", error_json(error)}});
    throw CLI::RuntimeError(error.exit_code());
  }
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("validate", "Check a pipeline file, and its dumps against it, without running");
  const auto options = std::make_shared<ValidateOptions>();
  add_pipeline_arguments(*command, options->pipeline);
  command->add_flag("--no-input", options->no_input, "Do not look at the dumps");
  command->add_flag("--json", options->json, "Print the verdict as JSON");
  command->footer(validate_footer);
  command->callback([options] { validate(*options); });
}

}  // namespace grainvdb::cli
