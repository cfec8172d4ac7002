#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <tbb/global_control.h>

#include "cli/commands.hpp"
#include "cli/dry_run.hpp"
#include "cli/interrupt.hpp"
#include "cli/open_input.hpp"
#include "cli/output_folder.hpp"
#include "cli/report.hpp"
#include "cli/reporting.hpp"
#include "cli/run_record.hpp"
#include "cli/spot_commands.hpp"
#include "cli/write_tables.hpp"
#include "grainvdb/run.hpp"
#include "spot/calibration.hpp"
#include "spot/comparison.hpp"
#include "spot/spot_file.hpp"
#include "write/text_file.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* spot_calibrate_footer = R"(Examples:
  grainvdb spot calibrate pipelines/spot_calibrate.yaml --output calibrated
  grainvdb spot run calibrated/spot.yaml --output spot
  grainvdb spot calibrate my.yaml --frames 10: --set measure.spot_calibration.lags=8
  grainvdb spot calibrate my.yaml --by-comparison --runs 6 --output corrected

Measures what the section measure.spot_calibration of the pipeline file describes, prints the parameters of the spot
model with their errors, and writes them with all that they come from as tables, and as DIR/spot.yaml, a file for
'grainvdb spot run' whose packing is the first of the frames. docs/spot_calibration.md tells how they are found.

The estimates hold for spots that only move grains. Pushing overlapping grains apart, as runs usually do, changes what
is seen of them. --by-comparison runs the spot file, measures the runs as the dumps were, and takes off what the
estimates make of known parameters, in rounds; errors then contain what such runs scatter by. It takes rounds x runs
times as long as one run, shared out over the threads.)";

struct SpotCalibrateOptions {
  PipelineArguments pipeline;
  std::string output = "calibrated";
  bool by_comparison = false;
  spot::ComparisonOptions comparison;
  std::size_t threads = 0;
  bool dry_run = false;
  Reporting reporting;
};

Pipeline calibration_alone(const SpotCalibrateOptions& options) {
  Pipeline pipeline = load_pipeline(options.pipeline.file, options.pipeline.settings());
  spot::check_calibration(pipeline);
  pipeline.fields.clear();
  pipeline.formats.clear();
  pipeline.trace.reset();
  std::erase_if(pipeline.measure, [](const auto& entry) { return entry.first != "spot_calibration"; });
  return pipeline;
}

RunReport measured(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const Reporting& reporting) {
  const ProgressViews views(reporting);
  return run_pipeline(pipeline, plan, source, {}, [&](const Progress& progress) { views.show(progress); });
}

void print_parameters(const RunReport& report) {
  RunReport shown = report;
  std::erase_if(shown.tables, [](const Table& table) {
    return table.name != "spot_calibration" && table.name != "spot_calibration_by_comparison";
  });
  std::cout << cli::describe(shown);
}

/// Puts the corrected parameters first.
void compare(const SpotCalibrateOptions& options, const Pipeline& pipeline, FrameSource& source, RunReport& report) {
  const ProgressViews views(options.reporting);
  Table corrected = spot::calibrate_by_comparison(pipeline, report.tables.front(), source, options.comparison,
                                                  options.output, [&](std::size_t done, std::size_t all) {
                                                    views.show({done, all, "comparison runs"});
                                                  });
  report.tables.insert(report.tables.begin(), std::move(corrected));
}

void calibrate_dry(const SpotCalibrateOptions& options, const Pipeline& pipeline, const Plan& plan) {
  std::cout << describe(plan, pipeline) << '\n' << estimate(pipeline, plan, *open_input(pipeline, plan));
  if (options.by_comparison)
    std::cout << "would make at most " << options.comparison.rounds << " x " << options.comparison.runs
              << " runs of the spot file for comparison\n";
}

void calibrate(const SpotCalibrateOptions& options) {
  std::optional<tbb::global_control> threads;
  if (options.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  const Pipeline pipeline = calibration_alone(options);
  const Plan plan = make_plan(pipeline);
  if (options.dry_run) return calibrate_dry(options, pipeline, plan);
  check_output_folder(options.output);
  const auto source = open_input(pipeline, plan);
  watch_for_interrupts();
  RunReport report = measured(pipeline, plan, *source, options.reporting);
  write_tables(report, options.output);
  if (options.by_comparison) {
    compare(options, pipeline, *source, report);
    write_tables(report, options.output);
  }
  write_run_record(report, options.output);
  warn(options.reporting, warnings(report));
  if (!options.reporting.quiet) print_parameters(report);
  const std::string file = (std::filesystem::path(options.output) / "spot.yaml").string();
  write_text_file(file, spot::calibrated_spot_file(pipeline, report.tables.front(), *source));
  spot::load_spot_run(file);  // whether it can be run
  if (!options.reporting.quiet) std::cout << "wrote " << file << "\nrun it:\n  grainvdb spot run " << file << '\n';
}

void add_comparison_options(CLI::App& command, SpotCalibrateOptions& options) {
  spot::ComparisonOptions& comparison = options.comparison;
  CLI::Option* switched_on =
      command.add_flag("--by-comparison", options.by_comparison,
                       "Correct what was found by spot runs with known parameters, relaxed, measured in the same way");
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->needs(switched_on);
  };
  add("--rounds", comparison.rounds, "Rounds of such runs, each with the parameters found before, at most")
      ->type_name("N")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  add("--runs", comparison.runs, "Runs in a round, which differ by their seed")
      ->type_name("N")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  add("--duration", comparison.duration, "Time that is measured of each run; that of the frames by default")
      ->type_name("T")
      ->check(CLI::PositiveNumber);
  add("--height", comparison.height, "Height of their packing; that of the first frame by default")
      ->type_name("H")
      ->check(CLI::PositiveNumber);
  add("--seed", comparison.seed, "Seed of the first run")->type_name("N")->capture_default_str();
}

}  // namespace

void add_spot_calibrate(CLI::App& spot) {
  CLI::App* command = spot.add_subcommand("calibrate", "Find the spot model's parameters from dumps of a silo");
  const auto options = std::make_shared<SpotCalibrateOptions>();
  add_pipeline_arguments(*command, options->pipeline);
  command->add_option("-o,--output", options->output, "Folder for the tables and spot.yaml; made where there is none")
      ->type_name("DIR")
      ->capture_default_str();
  add_frames_option(*command, options->pipeline);
  add_comparison_options(*command, *options);
  command->add_option("--threads", options->threads, "Threads to use; all processors by default")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  add_log_option(*command, options->reporting);
  command->add_flag("--dry-run", options->dry_run, "Check everything and say what would be measured; write nothing");
  command->add_flag("-q,--quiet", options->reporting.quiet, "Print nothing but errors and warnings");
  command->footer(spot_calibrate_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { calibrate(*options); }); });
}

}  // namespace grainvdb::cli
