#include "grainvdb/run.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include "cli/commands.hpp"
#include "cli/dry_run.hpp"
#include "cli/interrupt.hpp"
#include "cli/number_checks.hpp"
#include "cli/open_input.hpp"
#include "cli/output_folder.hpp"
#include "cli/report.hpp"
#include "cli/reporting.hpp"
#include "cli/run_record.hpp"
#include "cli/write_tables.hpp"
#include "grainvdb/follow.hpp"
#include "grainvdb/scales.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/number.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* run_footer = R"(Examples:
  grainvdb run pipelines/shear_cell.yaml
  grainvdb run pipelines/shear_cell.yaml --output result --threads 4
  grainvdb run pipelines/shear_cell.yaml --frames -10: --set lattice.voxel=0.8e-3
  grainvdb run pipelines/shear_cell.yaml --set output.fields=[phi,velocity]
  grainvdb run pipelines/shear_cell.yaml --output result --resume
  grainvdb run pipelines/shear_cell.yaml --dry-run

Files appear under their names only when they are complete. Ctrl-C ends the run after the frame at hand and leaves no
file; a second Ctrl-C ends it at once and may leave a temporary one.)";

constexpr const char* trace_footer = R"(Examples:
  grainvdb trace pipelines/silo_elements.yaml
  grainvdb trace pipelines/silo_elements.yaml --output paths --set trace.record=[phi,mu]
  grainvdb trace pipelines/silo_elements.yaml --set trace.through=frames --set average.window=1 --frames 3:

Writes nothing but the histories that the section 'trace' of the pipeline file describes; 'run' writes them along with
the fields. 'grainvdb schema --text' explains its keys.)";

constexpr const char* measure_footer = R"(Examples:
  grainvdb measure pipelines/structure.yaml
  grainvdb measure pipelines/structure.yaml --output structure --set measure.pair_correlation.bins=200

Writes tables.h5 and tables/*.csv, and no fields; 'run' writes them along with the fields. What no table needs is neither
read nor computed. 'grainvdb measurements' lists what can be measured.)";

struct RunOptions {
  PipelineArguments pipeline;
  std::string output = "output";
  std::size_t threads = 0;
  bool resume = false;
  double checkpoint_interval = CheckpointOptions{}.interval;
  bool follow = false;
  FollowOptions waiting;
  bool dry_run = false;
  Reporting reporting;
};

template <class Sink, class Registry>
std::vector<std::unique_ptr<Sink>> make_sinks(const std::vector<std::string>& formats, const Registry& registry,
                                              const std::string& folder) {
  std::vector<std::unique_ptr<Sink>> sinks;
  for (const std::string& format : formats)
    for (const auto& sink : registry)
      if (sink.name == format) sinks.push_back(sink.make(folder));
  return sinks;
}

/// The pipeline with its plan, and with files in a folder that can take them.
ScaleRun make_run(Pipeline pipeline, const std::string& folder) {
  ScaleRun run;
  run.plan = make_plan(pipeline);
  check_output_folder(folder);
  run.sinks = make_sinks<FieldSink>(pipeline.formats, sink_registry(), folder);
  if (pipeline.trace)
    run.tracer_sinks = make_sinks<TracerSink>(pipeline.trace->formats, tracer_sink_registry(), folder);
  run.pipeline = std::move(pipeline);
  return run;
}

/// work(show) on as many threads as are wanted; show(progress) is for it to call again and again.
template <class F>
auto with_progress(const RunOptions& options, F work) {
  std::optional<tbb::global_control> threads;
  if (options.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  watch_for_interrupts();
  const ProgressViews views(options.reporting);
  return work([&](const Progress& progress) { views.show(progress); });
}

void run_once(const Pipeline& pipeline, const RunOptions& options) {
  const ScaleRun run = make_run(pipeline, options.output);
  std::optional<CheckpointOptions> checkpoint;
  if (options.resume || options.follow) checkpoint = CheckpointOptions{options.output, options.checkpoint_interval};
  RunReport report = with_progress(options, [&](const auto& show) {
    if (!options.follow)
      return run_pipeline(run.pipeline, run.plan, *open_input(run.pipeline, run.plan), run.sinks, run.tracer_sinks,
                          show, checkpoint);
    FollowedInput input(needed_input(run.pipeline, run.plan));
    return follow_pipeline(run.pipeline, run.plan, input, run.sinks, run.tracer_sinks, options.waiting, *checkpoint,
                           show);
  });
  write_tables(report, options.output);
  write_run_record(report, options.output);
  warn(options.reporting, warnings(report));
  if (!options.reporting.quiet) std::cout << describe(report);
}

std::string folder_of_scale(const std::string& output, const Pipeline& pipeline) {
  return (std::filesystem::path(output) / ("c" + print_number(pipeline.cutoff) + "_h" + print_number(pipeline.voxel)))
      .string();
}

void run_at_scales(const Pipeline& pipeline, const RunOptions& options) {
  if (options.resume || options.follow)
    throw ConfigError({pipeline.location("scales"),
                       "several scales can neither be resumed nor followed",
                       {},
                       "one scale, or neither --resume nor --follow",
                       {}});
  if (measured_columns(pipeline) || measures_planes(pipeline))
    throw ConfigError({pipeline.location("measure"),
                       "frames are not measured at several scales",
                       "both scales and measurements of frames",
                       "one of them",
                       {}});
  std::vector<ScaleRun> runs;
  std::vector<std::string> names;
  for (const Pipeline& p : at_scales(pipeline)) {
    runs.push_back(make_run(p, folder_of_scale(options.output, p)));
    names.push_back(scale_name(p));
  }
  std::vector<RunReport> reports = with_progress(options, [&](const auto& show) {
    return run_scales(runs, *open_input(runs.front().pipeline, runs.front().plan), show);
  });
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::string folder = folder_of_scale(options.output, runs[n].pipeline);
    write_tables(reports[n], folder);
    write_run_record(reports[n], folder);
  }
  warn(options.reporting, warnings(reports, names));
  if (options.reporting.quiet) return;
  for (std::size_t n = 0; n < runs.size(); ++n) std::cout << names[n] << '\n' << describe(reports[n]);
}

void run_dry(const Pipeline& pipeline) {
  for (const Pipeline& p : at_scales(pipeline)) {
    const Plan plan = make_plan(p);
    std::cout << describe(plan, p) << '\n' << estimate(p, plan, *open_input(p, plan));
  }
}

void run(const Pipeline& pipeline, const RunOptions& options) {
  if (options.dry_run) return run_dry(pipeline);
  pipeline.scales.empty() ? run_once(pipeline, options) : run_at_scales(pipeline, options);
}

Pipeline load(const RunOptions& options) {
  return load_pipeline(options.pipeline.file, options.pipeline.settings());
}

// Something must end the waiting.
void run_or_follow(const RunOptions& options) {
  if (options.follow && !options.waiting.last_step && !options.waiting.timeout)
    throw ConfigError({{}, "--follow needs an end", {}, "--last-step N, --timeout SECONDS, or both", {}});
  run(load(options), options);
}

void trace(const RunOptions& options) {
  Pipeline pipeline = load(options);
  if (!pipeline.trace)
    throw ConfigError({Location{pipeline.file},
                       "there is nothing to trace: the section 'trace' is missing",
                       {},
                       "trace, with the seeds of tracers",
                       "'grainvdb schema --text' explains its keys"});
  pipeline.fields.clear();
  pipeline.formats.clear();
  pipeline.measure.clear();
  run(pipeline, options);
}

void measure(const RunOptions& options) {
  Pipeline pipeline = load(options);
  if (pipeline.measure.empty())
    throw ConfigError({Location{pipeline.file},
                       "there is nothing to measure: the section 'measure' is missing",
                       {},
                       "measure, with a section for each measurement",
                       "'grainvdb measurements' lists them"});
  pipeline.fields.clear();
  pipeline.formats.clear();
  pipeline.trace.reset();
  run(pipeline, options);
}

void add_options(CLI::App& command, RunOptions& options) {
  add_pipeline_arguments(command, options.pipeline);
  command.add_option("-o,--output", options.output, "Folder for the results; made where there is none")
      ->type_name("DIR")
      ->capture_default_str();
  add_frames_option(command, options.pipeline);
  command.add_option("--threads", options.threads, "Threads to use; all processors by default")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  command
      .add_option("--progress-file", options.reporting.progress_file,
                  "Keep how far the run is in this file, as JSON, for batch systems")
      ->type_name("FILE");
  add_log_option(command, options.reporting);
  command.add_flag("--dry-run", options.dry_run,
                   "Check everything, compute one frame and estimate what all would take; write nothing");
  command.add_flag("-q,--quiet", options.reporting.quiet, "Print nothing but errors and warnings");
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command = app.add_subcommand("run", "Run a pipeline: read dumps, compute fields, write them");
  const auto options = std::make_shared<RunOptions>();
  add_options(*command, *options);
  CLI::Option* resume = command->add_flag(
      "--resume", options->resume,
      "Save the state of the run in the output folder, and go on from there where it was interrupted before");
  command
      ->add_option("--checkpoint-interval", options->checkpoint_interval,
                   "Seconds from one state that is saved to the next")
      ->type_name("SECONDS")
      ->check(nonnegative_number())
      ->needs(resume)
      ->capture_default_str();
  CLI::Option* follow = command->add_flag(
      "--follow", options->follow,
      "Take frames as a simulation writes them, and write the results at the end that --last-step or --timeout names");
  command->add_option("--last-step", options->waiting.last_step, "With --follow: the step of the last frame to take")
      ->type_name("N")
      ->needs(follow);
  command
      ->add_option("--timeout", options->waiting.timeout,
                   "With --follow: end when no frame has come for so many seconds")
      ->type_name("SECONDS")
      ->check(nonnegative_number())
      ->needs(follow);
  command
      ->add_option("--look-every", options->waiting.interval,
                   "With --follow: seconds from one look at the input to the next; a frame is taken when its file has "
                   "not changed in between")
      ->type_name("SECONDS")
      ->check(positive_number())
      ->needs(follow)
      ->capture_default_str();
  command->footer(run_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { run_or_follow(*options); }); });
}

void add_trace(CLI::App& app) {
  CLI::App* command = app.add_subcommand("trace", "Move tracers with the material and write what they meet");
  const auto options = std::make_shared<RunOptions>();
  add_options(*command, *options);
  command->footer(trace_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { trace(*options); }); });
}

void add_measure(CLI::App& app) {
  CLI::App* command = app.add_subcommand("measure", "Make the tables that a pipeline asks for, and nothing else");
  const auto options = std::make_shared<RunOptions>();
  add_options(*command, *options);
  command->footer(measure_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { measure(*options); }); });
}

}  // namespace grainvdb::cli
