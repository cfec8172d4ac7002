#pragma once
/// The subcommands. Each adds itself to the application; its work is done in a callback that runs once the whole
/// command line has been understood, and reports failure by throwing.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace grainvdb::cli {

void add_run(CLI::App& app);
void add_trace(CLI::App& app);
void add_measure(CLI::App& app);
void add_measurements(CLI::App& app);
void add_info(CLI::App& app);
void add_init(CLI::App& app);
void add_validate(CLI::App& app);
void add_stages(CLI::App& app);
void add_graph(CLI::App& app);
void add_schema(CLI::App& app);
void add_spot(CLI::App& app);
void add_report(CLI::App& app);
void add_tune(CLI::App& app);
void add_completion(CLI::App& app);
void add_man(CLI::App& app);

/// The argument PIPELINE and the options --set and --frames, as several subcommands take them.
struct PipelineArguments {
  std::string file;
  std::vector<std::string> overrides;
  std::string frames;

  /// What is set: --frames is short for --set frames=...
  std::vector<std::string> settings() const;
};
/// What a subcommand reads: a pipeline file, or another that is written in the same way.
struct FileArgument {
  const char* name = "pipeline";
  const char* type = "PIPELINE";
  const char* help = "The pipeline file";
  const char* keys = "kernel.cutoff=2.4e-3 or output.fields=[phi,velocity]";
};
void add_pipeline_arguments(CLI::App& command, PipelineArguments& arguments, const FileArgument& file = {});
void add_frames_option(CLI::App& command, PipelineArguments& arguments);

}  // namespace grainvdb::cli
