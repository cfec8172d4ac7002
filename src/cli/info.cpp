#include <algorithm>
#include <iostream>
#include <locale>
#include <memory>
#include <numeric>
#include <sstream>

#include "cli/commands.hpp"
#include "cli/dry_run.hpp"
#include "cli/input_options.hpp"
#include "cli/open_input.hpp"
#include "cli/report.hpp"
#include "cli/survey.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/scales.hpp"
#include "pipeline/number.hpp"
#include "pipeline/spot_input.hpp"

namespace grainvdb::cli {
namespace {

constexpr const char* info_footer = R"(Examples:
  grainvdb info dumps/
  grainvdb info 'dumps/dump*.liggghts' --contacts 'dumps/contacts*.liggghts'
  grainvdb info 'post/grains_[0-9]*.vtk' --periodic x --box 0 0 0 0.004 0.01 0.01
  grainvdb info run.dump.gz --list
  grainvdb info dumps/ --pipeline pipelines/shear_cell.yaml

Headers are read of every frame, grains of the last one. A type flows unless all its grains rest or have one velocity,
as those of walls do; the suggestion is for the grains that flow. `grainvdb init` makes a pipeline file of it. With
--pipeline one frame is computed, and what all would take is said.)";

struct InfoOptions {
  InputSpec input;
  bool list = false;
  std::string pipeline;  ///< file; empty for none
};

std::string frame_text(const FrameInfo& frame) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << "step " << frame.step;
  if (frame.time) text << ", time " << *frame.time;
  text << ", " << frame.particle_count << " particles";
  return text.str();
}

std::string box_text(const Box& box) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  for (int a = 0; a < 3; ++a)
    text << (a > 0 ? ", " : "") << "xyz"[a] << ' ' << box.lo[a] << " ... " << box.hi[a]
         << (box.periodic[a] ? " periodic" : "");
  return text.str();
}

void print_steps(const std::vector<FrameInfo>& frames) {
  if (frames.size() < 2) return;
  std::int64_t least = frames[1].step - frames[0].step, most = least;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const std::int64_t gap = frames[k].step - frames[k - 1].step;
    least = std::min(least, gap);
    most = std::max(most, gap);
  }
  std::cout << "spacing: " << least;
  if (most != least) std::cout << " ... " << most;
  std::cout << " steps\n";
  // A gap is more than half as wide again as the closest frames are.
  std::vector<std::int64_t> before_gaps;
  for (std::size_t k = 1; k < frames.size(); ++k)
    if (2 * (frames[k].step - frames[k - 1].step) > 3 * least) before_gaps.push_back(frames[k - 1].step);
  if (before_gaps.empty()) return;
  constexpr std::size_t shown = 5;
  std::cout << "gaps: " << before_gaps.size() << ", after step ";
  for (std::size_t n = 0; n < std::min(shown, before_gaps.size()); ++n)
    std::cout << (n > 0 ? ", " : "") << before_gaps[n];
  std::cout << (before_gaps.size() > shown ? ", ...\n" : "\n");
}

void print_frames(const std::vector<FrameInfo>& frames, bool list) {
  std::cout << "frames: " << frames.size() << '\n';
  if (list) {
    for (const FrameInfo& frame : frames) std::cout << "  " << frame_text(frame) << "  " << frame.file << '\n';
  } else {
    std::cout << "  first " << frame_text(frames.front()) << '\n';
    std::cout << "  last  " << frame_text(frames.back()) << '\n';
  }
  print_steps(frames);
  const auto [fewest, most] = std::minmax_element(
      frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.particle_count < b.particle_count; });
  std::cout << "particles: " << fewest->particle_count;
  if (most->particle_count != fewest->particle_count) std::cout << " ... " << most->particle_count;
  std::cout << '\n';
  const bool same_box =
      std::all_of(frames.begin(), frames.end(), [&](const auto& f) { return f.box == frames[0].box; });
  std::cout << "box: " << box_text(frames.front().box) << (same_box ? "" : " (changes)") << '\n';
}

void print_columns(const char* what, const std::vector<std::string>& columns) {
  std::cout << what << ": ";
  for (std::size_t i = 0; i < columns.size(); ++i) std::cout << (i > 0 ? " " : "") << columns[i];
  std::cout << " (" << columns.size() << ")\n";
}

void print_grains(const Survey& survey) {
  std::cout << "grains of the last frame:\n";
  for (const Kind& kind : survey.kinds) {
    std::cout << "  ";
    if (survey.has_types) std::cout << "type " << kind.type << ": ";
    std::cout << kind.count;
    if (survey.has_sizes) {
      std::cout << ", diameter " << short_number(kind.mean);
      if (kind.least != kind.greatest)
        std::cout << " (" << short_number(kind.least) << " ... " << short_number(kind.greatest) << ')';
    }
    if (kind.motion != Motion::unknown) std::cout << ", " << name_of(kind.motion);
    std::cout << '\n';
  }
  if (survey.contacts) std::cout << "contacts of the last frame: " << *survey.contacts << '\n';
}

void print_suggestion(const Survey& survey, const Box& box) {
  if (!survey.has_sizes) return;
  const double d = survey.mean_diameter();
  const std::optional<double> voxel = suggested_voxel(d, box);
  std::cout << "suggested: kernel.cutoff " << print_number(suggested_cutoff(d, box)) << " ("
            << short_number(suggested_cutoff(d, box) / d) << " mean diameters), lattice.voxel "
            << (voxel ? print_number(*voxel) : "none (no voxel near half a diameter fits all periodic lengths)")
            << '\n';
}

/// What a pipeline would take on these dumps instead of its own.
void print_estimates(const InfoOptions& options) {
  Pipeline pipeline = load_pipeline(options.pipeline, {});
  pipeline.input.particles = options.input.particles;
  if (!options.input.contacts.files.empty()) pipeline.input.contacts.files = options.input.contacts.files;
  if (!options.input.wall_contacts.files.empty())
    pipeline.input.wall_contacts.files = options.input.wall_contacts.files;
  if (options.input.dt) pipeline.input.dt = options.input.dt;
  if (options.input.periodic) pipeline.input.periodic = options.input.periodic;
  if (options.input.box) pipeline.input.box = options.input.box;
  for (const Pipeline& p : at_scales(pipeline)) {
    const Plan plan = make_plan(p);
    std::cout << "with " << options.pipeline << (pipeline.scales.empty() ? "" : ", " + scale_name(p)) << ":\n"
              << estimate(p, plan, *open_input(p, plan));
  }
}

void info(const InfoOptions& options) {
  const auto source = open_dumps(options.input);
  print_frames(source->frames(), options.list);
  print_columns("columns", source->particle_columns());
  const std::vector<std::string> contact_columns = source->contact_columns();
  if (!contact_columns.empty()) print_columns("contact columns", contact_columns);
  const std::vector<std::string> wall_contact_columns = source->wall_contact_columns();
  if (!wall_contact_columns.empty()) print_columns("wall contact columns", wall_contact_columns);
  if (is_spot_run(*source)) std::cout << "snapshots: " << spot_snapshots << '\n';
  std::cout << "units: " << source->units().name << '\n';
  const Survey last = survey(*source, source->frames().size() - 1);
  print_grains(last);
  print_suggestion(last, source->frames().back().box);
  const auto files = source->files();
  const std::uintmax_t bytes = std::accumulate(files.begin(), files.end(), std::uintmax_t{0},
                                               [](std::uintmax_t sum, const auto& file) { return sum + file.second; });
  std::cout << "files: " << files.size() << ", " << bytes << " bytes\n";
  if (!options.pipeline.empty()) print_estimates(options);
}

}  // namespace

void add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Say what is in dump files");
  const auto options = std::make_shared<InfoOptions>();
  add_input_options(*command, options->input);
  command->add_flag("--list", options->list, "List every frame");
  command->add_option("--pipeline", options->pipeline, "Estimate memory and time of this pipeline on these dumps")
      ->type_name("FILE");
  command->footer(info_footer);
  command->callback([options] { info(*options); });
}

}  // namespace grainvdb::cli
