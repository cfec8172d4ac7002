#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/output_folder.hpp"
#include "cli/reporting.hpp"
#include "cli/spot_commands.hpp"
#include "spot/run_spot.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* spot_run_footer = R"(Examples:
  grainvdb spot run pipelines/spot_silo.yaml --output spot
  grainvdb spot run pipelines/spot_silo.yaml --set relaxation.every=0 --set seed=2 -o unrelaxed
  grainvdb info spot

The dumps are read by every other command. Each appears under its name when it is complete; Ctrl-C leaves those that are
done. The same file and seed give the same dumps.)";

struct SpotRunOptions {
  PipelineArguments file;
  std::string output = "spot";
  bool dry_run = false;
  Reporting reporting;
};

void print(const spot::SpotRun& run, const spot::SpotReport& report, const std::string& folder) {
  const spot::SpotCounters& c = report.counters;
  std::cout << report.snapshots << " snapshots until time " << report.time << " in " << folder << '\n';
  std::cout << "particles: " << report.particles_at_start << " at the start, " << report.drained << " drained, "
            << report.particles_at_end << " left";
  if (run.left_out > 0) std::cout << " (" << run.left_out << " of the dump lie outside the container)";
  std::cout << (run.voids ? "\nvoids: " : "\nspots: ") << c.inserted + run.parameters.count << " entered, " << c.removed
            << " left, " << c.steps;
  if (run.voids)
    std::cout << " hops\n";
  else
    std::cout << " steps, " << c.relaxed << " of them relaxed\n";
}

void print_dry(const spot::SpotRun& run) {
  std::cout << run.resolved << "\nwould begin with " << run.packing.id.size() << " particles";
  if (run.left_out > 0) std::cout << " (" << run.left_out << " of the dump lie outside the container)";
  std::cout << " and write at most " << spot::most_snapshots(run) << " snapshots until time " << run.end << '\n';
}

void run_spots(const SpotRunOptions& options) {
  check_output_folder(options.output);
  spot::refuse_used_folder(options.output);
  const spot::SpotRun run = spot::load_spot_run(options.file.file, options.file.overrides);
  if (options.dry_run) return print_dry(run);
  watch_for_interrupts();
  spot::SpotReport report;
  {
    const ProgressViews views(options.reporting);
    report = spot::run_spot(run, options.output, [&](std::size_t done, std::size_t all) {
      views.show({done, all, "snapshots"});
    });
  }
  if (!options.reporting.quiet) print(run, report, options.output);
}

void add_run_subcommand(CLI::App& spot) {
  CLI::App* command = spot.add_subcommand("run", "Run the spot model and write dumps");
  const auto options = std::make_shared<SpotRunOptions>();
  add_pipeline_arguments(*command, options->file,
                         {"spot_file", "FILE", "The spot file", "output.end=20 or spots.step=[0.5,0.5,0.1]"});
  command->add_option("-o,--output", options->output, "Folder for the dumps; made where there is none")
      ->type_name("DIR")
      ->capture_default_str();
  add_log_option(*command, options->reporting);
  command->add_flag("--dry-run", options->dry_run,
                    "Check the file and its packing, print all its keys and say what would be run; write nothing");
  command->add_flag("-q,--quiet", options->reporting.quiet, "Print nothing but errors");
  command->footer(spot_run_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { run_spots(*options); }); });
}

}  // namespace

void add_spot(CLI::App& app) {
  CLI::App* command = app.add_subcommand("spot", "Make snapshots with the spot model, and calibrate it");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n  grainvdb spot run pipelines/spot_silo.yaml --output spot\n"
      "  grainvdb spot calibrate pipelines/spot_calibrate.yaml --output calibrated");
  add_run_subcommand(*command);
  add_spot_calibrate(*command);
}

}  // namespace grainvdb::cli
