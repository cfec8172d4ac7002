#include "grainvdb/tune.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tbb/global_control.h>

#include "cli/commands.hpp"
#include "cli/dry_run.hpp"
#include "cli/interrupt.hpp"
#include "cli/open_input.hpp"
#include "cli/output_folder.hpp"
#include "cli/python.hpp"
#include "cli/reporting.hpp"
#include "pipeline/number.hpp"
#include "pipeline/text.hpp"
#include "write/text_file.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* tune_footer = R"(Examples:
  grainvdb tune pipelines/shear_cell.yaml
  grainvdb tune pipelines/shear_cell.yaml --tolerance phi=1e-2,stress=3e-2
  grainvdb tune my.yaml --tolerance position=0.1,profile.phi=1e-4
  grainvdb tune my.yaml --frames :3 --knobs lattice.voxel,frames --repeats 5
  grainvdb tune my.yaml --try stages.contact_stress.line_integral=gauss1,gauss2 --set output.fields=[stress]

Each value is tried by itself, then the combinations that promise most. Errors are distances from a reference run with
half the voxel, line integrals in closed form, sums in double and gradients of the kernel; what the reference does
otherwise can be set with --reference, e.g. --reference kernel.accumulation=shifted. Where the pipeline has tracers,
'position' is how far they end from those of the reference, in mean diameters; where it measures a profile,
'profile.phi' and so on are the errors of averages over planes. Take few frames and a part of the fields where the data
are large: the reference takes long. Writes DIR/tune.csv and, with python3-matplotlib, DIR/tune.png.)";

struct TuneOptions {
  PipelineArguments pipeline;
  std::vector<std::string> tolerance, knobs, tries, reference;
  std::size_t repeats = 3;
  std::size_t threads = 1;
  std::size_t most_runs = 120;
  std::string output = "tune";
  bool dry_run = false;
  bool no_picture = false;
  Reporting reporting;
};

ConfigError bad_option(const char* option, const std::string& what, const std::string& found, const std::string& hint) {
  return ConfigError({{option, 0}, what, found, {}, hint});
}

/// "phi=1e-3" apart; several may stand in one text, with commas between them.
std::map<std::string, double> tolerances(const std::vector<std::string>& texts) {
  std::map<std::string, double> result;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parse_number(text.substr(equals + 1));
    if (!value || !(*value > 0) || equals == 0)
      throw bad_option("--tolerance", "a tolerance must have the form field=number, the number > 0", quote_text(text),
                       "E.g. --tolerance phi=1e-3,stress=1e-2");
    result[text.substr(0, equals)] = *value;
  }
  return result;
}

/// "key=a,b,[c,d]" apart at the commas outside brackets.
Knob knob_of(const std::string& text) {
  const auto equals = text.find('=');
  Knob knob{text.substr(0, equals), {}};
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw bad_option("--try", "values to try must have the form key=value,value,...", quote_text(text),
                     "E.g. --try kernel.cutoff=2.0e-3,2.8e-3");
  if (knob.key.starts_with("input") || knob.key.starts_with("output") || knob.key.starts_with("average"))
    throw bad_option("--try", "what is read, averaged and written must stay the same for results to be compared",
                     knob.key, {});
  int depth = 0;
  std::string value;
  for (char c : text.substr(equals + 1)) {
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c == ',' && depth == 0) {
      knob.values.push_back(value);
      value.clear();
    } else {
      value += c;
    }
  }
  knob.values.push_back(value);
  return knob;
}

std::vector<std::string> keys(const std::vector<Knob>& knobs) {
  std::vector<std::string> names;
  for (const Knob& k : knobs) names.push_back(k.key);
  return names;
}

/// Those that --knobs names among what is tried by default, and those of --try, which take the place of equal keys.
std::vector<Knob> chosen_knobs(const TuneOptions& options, std::vector<Knob> knobs) {
  const std::vector<std::string> known = keys(knobs);
  for (const std::string& name : options.knobs)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw ConfigError({{"--knobs", 0},
                         "nothing is tried of " + quote_text(name),
                         {},
                         known.empty() ? "values by --try" : join_choices(known),
                         did_you_mean(name, known)});
  const bool only_tries = options.knobs.empty() && !options.tries.empty();
  std::erase_if(knobs, [&](const Knob& k) {
    const bool named = std::find(options.knobs.begin(), options.knobs.end(), k.key) != options.knobs.end();
    return only_tries || (!options.knobs.empty() && !named);
  });
  for (const std::string& text : options.tries) {
    const Knob knob = knob_of(text);
    std::erase_if(knobs, [&](const Knob& k) { return k.key == knob.key; });
    knobs.push_back(knob);
  }
  return knobs;
}

TuneRequest request_of(const TuneOptions& options) {
  TuneRequest request;
  request.file = options.pipeline.file;
  request.overrides = options.pipeline.settings();
  request.reference = options.reference;
  request.tolerance = tolerances(options.tolerance);
  request.repeats = options.repeats;
  request.most_runs = options.most_runs;
  return request;
}

Pipeline at_one_scale(const TuneRequest& request) {
  Pipeline pipeline = load_pipeline(request.file, request.overrides);
  if (!pipeline.scales.empty())
    throw ConfigError({pipeline.location("scales"), "settings are compared at one scale",
                       std::to_string(pipeline.scales.size()) + " scales", "a pipeline file without scales",
                       "Cutoffs and voxels are tried by --try kernel.cutoff=A,B and --try lattice.voxel=A,B."});
  return pipeline;
}

TuneReport run_all(TuneRequest& request, FrameSource& source, const Reporting& reporting) {
  watch_for_interrupts();
  std::optional<ProgressViews> views;
  request.progress = [&](const TuneRequest::Step& step) {
    if (step.frames_total == 0) views.emplace(reporting);  // a run begins, and its time
    views->show(
        {step.frames, step.frames_total,
         "run " + std::to_string(step.run + 1) + " of at most " + std::to_string(step.runs) + ", " + step.what});
  };
  return tune(request, source);
}

void draw(const TuneOptions& options, const std::string& table) {
  try {
    become_python("grainvdb.tune", {table, (std::filesystem::path(options.output) / "tune.png").string()},
                  {"h5py", "matplotlib"});
  } catch (const IoError& error) {
    warn(options.reporting, std::string("grainvdb: warning: no picture was drawn: ") + error.what() + '\n');
  }
}

void tune_pipeline(const TuneOptions& options) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, options.threads);
  TuneRequest request = request_of(options);
  const Pipeline pipeline = at_one_scale(request);
  const Plan plan = make_plan(pipeline);
  check_output_folder(options.output);
  const auto source = open_input(pipeline, plan);
  request.knobs = chosen_knobs(options, default_knobs(pipeline, plan, *source));
  if (options.dry_run) {
    std::cout << describe(plan_tuning(request, *source)) << "as it is:\n" << estimate(pipeline, plan, *source);
    return;
  }
  const TuneReport report = run_all(request, *source, options.reporting);
  const std::string table = (std::filesystem::path(options.output) / "tune.csv").string();
  write_text_file(table, to_csv(report, request.tolerance));
  if (!options.reporting.quiet)
    std::cout << describe(report, request.tolerance) << "Best of " << options.repeats
              << (options.repeats == 1 ? " run on " : " runs on ") << options.threads
              << (options.threads == 1 ? " thread" : " threads") << ".\nwrote " << table << '\n';
  if (!options.no_picture) draw(options, table);
}

}  // namespace

void add_tune(CLI::App& app) {
  CLI::App* command = app.add_subcommand("tune", "Measure speed against accuracy of a pipeline's settings");
  const auto options = std::make_shared<TuneOptions>();
  add_pipeline_arguments(*command, options->pipeline);
  add_frames_option(*command, options->pipeline);
  command
      ->add_option("--tolerance", options->tolerance,
                   "Largest relative error of a field, profile.FIELD or position; the fastest setting that keeps to "
                   "all of them is "
                   "proposed")
      ->type_name("FIELD=X,...")
      ->delimiter(',');
  command->add_option("--knobs", options->knobs, "Keys to try, of those tried by default")
      ->type_name("KEY,...")
      ->delimiter(',');
  command
      ->add_option("--try", options->tries, "Values to try of any key but those of input and output; may be repeated")
      ->type_name("KEY=A,B,...")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--reference", options->reference, "Set a key for the reference run; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--repeats", options->repeats, "Runs of each setting; the fastest counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--max-runs", options->most_runs, "Runs of the pipeline at most; more are refused")
      ->type_name("N")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to use")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Folder for the table and the picture")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_flag("--no-picture", options->no_picture, "Draw nothing");
  add_log_option(*command, options->reporting);
  command->add_flag("--dry-run", options->dry_run,
                    "Check everything, list what would be tried and estimate one run; write nothing");
  command->add_flag("-q,--quiet", options->reporting.quiet, "Print nothing but errors and warnings");
  command->footer(tune_footer);
  command->callback([options] { with_errors_logged(options->reporting, [&] { tune_pipeline(*options); }); });
}

}  // namespace grainvdb::cli
