#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <utility>

#include "cli/commands.hpp"
#include "cli/draft.hpp"
#include "cli/input_options.hpp"
#include "cli/number_checks.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"

namespace grainvdb::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* init_footer = R"(Examples:
  grainvdb init dumps/
  grainvdb init 'post/dump*.liggghts' --contacts 'post/contacts*.liggghts' --contact-compute pos id force contactPoint delta \
      --units si --dt 1e-6 --output shear.yaml
  grainvdb init 'full_*.dump' --contacts 'contacts_*.dump' --contact-lammps pp pl --output silo.yaml
  grainvdb init run.dump.gz --density 2500 --output run.yaml
  grainvdb init 'grains*.dump' --wall-contacts 'walls*.dump' --wall-contact-compute pos id force

The file names the grains that flow as material, a kernel of three mean diameters, voxels of half a diameter that fit the
periodic box, and the common fields for which the dumps have what they need. It is checked as `grainvdb validate` does.)";

struct InitOptions {
  InputSpec input;
  std::string file = "pipeline.yaml";
};

// Patterns as they must stand in a file of that folder.
std::vector<std::string> relative_to(const fs::path& folder, const std::vector<std::string>& patterns) {
  std::vector<std::string> result;
  for (const std::string& pattern : patterns) {
    const fs::path path(pattern);
    result.push_back(path.is_absolute() ? pattern
                                        : fs::absolute(path).lexically_normal().lexically_relative(folder).string());
  }
  return result;
}

void write(const fs::path& path, const std::string& text) {
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  if (!(out << text << std::flush)) throw IoError("cannot write", path.string(), errno);
}

ContactDumps contact_dumps(FrameSource& source, std::vector<std::string> columns, Column contacts) {
  if (columns.empty()) return {};
  try {
    source.require(0, contacts);
    return {std::move(columns), true};
  } catch (const Error&) {
    return {std::move(columns), false};
  }
}

bool knows_wall_contacts(FrameSource& source) {
  try {
    source.require(0, Column::wall_contacts);
    return true;
  } catch (const Error&) {
    return false;
  }
}

// Contacts with walls may stand among those of grains, as in .fstat files of MercuryDPM, which then are named for both:
// without them stresses lack the share of the walls.
InputSpec with_wall_contacts(const InputSpec& input) {
  if (input.contacts.files.empty() || !input.wall_contacts.files.empty()) return input;
  InputSpec both = input;
  both.wall_contacts.files = input.contacts.files;
  const auto source = open_dumps(both);
  if (!knows_wall_contacts(*source)) return input;
  const std::size_t last = source->frames().size() - 1;
  return source->read(last, Column::wall_contacts).wall_contacts.size() > 0 ? both : input;
}

// What the command line says of columns has to fit the dumps.
void require_named(FrameSource& source, const InputSpec& input) {
  if (!input.contacts.compute.empty() || !input.contacts.columns.empty()) source.require(0, Column::contacts);
  if (!input.wall_contacts.compute.empty()) source.require(0, Column::wall_contacts);
}

void say_if_unknown(const ContactDumps& dumps, const std::string& noun, const std::string& section,
                    const std::string& options) {
  if (!dumps.columns.empty() && !dumps.known)
    std::cout << "The columns of the " << noun << " dumps are not known: see " << section
              << " there, or name them with\n"
              << options << ".\n";
}

void refuse_to_replace(const std::string& file) {
  if (fs::exists(file))
    throw ConfigError({{file, 0},
                       "the file is there already",
                       {},
                       "the name of a new file",
                       "Give another one with --output, or remove it"});
}

double voxel_for(const Survey& survey, const Box& box, const std::string& file) {
  if (!survey.has_sizes)
    throw InputError({{file, 0},
                      "the dump has no sizes of the grains",
                      {},
                      "a column radius or diameter",
                      "Give the radius of all grains with --radius"});
  const std::optional<double> voxel = suggested_voxel(survey.mean_diameter(), box);
  if (!voxel)
    throw InputError({{file, 0},
                      "no cubic voxel between a quarter and 0.6 of a diameter fits all periodic lengths of the box",
                      {},
                      {},
                      "Write the pipeline file by hand, with a voxel that divides them"});
  return *voxel;
}

bool needs_contacts(const Plan& plan) {
  return std::any_of(plan.sweeps.begin(), plan.sweeps.end(),
                     [](const Sweep& sweep) { return sweep.columns.has(Column::contacts); });
}

// "file:line: what; …" without the place, which is that of the trial, in one line.
std::string reason(const std::string& message) {
  const std::string line = message.substr(0, message.find('\n'));
  const std::size_t place = line.find(": ");
  return place == std::string::npos ? line : line.substr(place + 2);
}

// Sorts the common fields into those that a pipeline file could ask for and those that it could not.
void sort_fields(Draft& draft, const fs::path& file, FrameSource& source) {
  draft.fields.clear();
  for (const std::string& field : common_fields()) {
    const Pipeline pipeline = load_pipeline(file.string(), {"output.fields=[" + field + "]"});
    const Plan plan = make_plan(pipeline);
    if (needs_contacts(plan) && !draft.contacts.known) {
      draft.refused[field] = "needs contacts";
      continue;
    }
    try {
      check_against_input(pipeline, plan, source);
      draft.fields.push_back(field);
    } catch (const InputError& refusal) {
      draft.refused[field] = reason(refusal.what());
    }
  }
}

void init(const InitOptions& options) {
  refuse_to_replace(options.file);
  const InputSpec input = with_wall_contacts(options.input);
  const auto source = open_dumps(input);
  require_named(*source, input);
  const FrameInfo& last = source->frames().back();
  const fs::path file = fs::absolute(options.file).lexically_normal();

  Draft draft;
  draft.input = input;
  draft.input.particles = relative_to(file.parent_path(), input.particles);
  draft.input.contacts.files = relative_to(file.parent_path(), input.contacts.files);
  draft.input.wall_contacts.files = relative_to(file.parent_path(), input.wall_contacts.files);
  draft.command = options.file;
  draft.contacts = contact_dumps(*source, source->contact_columns(), Column::contacts);
  draft.wall_contacts = contact_dumps(*source, source->wall_contact_columns(), Column::wall_contacts);
  draft.times_known = last.time.has_value();
  draft.units_known = source->units().name != "unspecified";
  draft.survey = survey(*source, source->frames().size() - 1);
  draft.box = last.box;
  draft.voxel = voxel_for(draft.survey, last.box, last.file);

  // Beside the file that it becomes, so that its paths mean the same.
  fs::path trial = file;
  trial += ".part";
  try {
    draft.fields = common_fields();
    write(trial, pipeline_text(draft));
    sort_fields(draft, trial, *source);
    write(trial, pipeline_text(draft));
    const Pipeline made = load_pipeline(trial.string());
    check_against_input(made, make_plan(made), *source);
    fs::rename(trial, file);
  } catch (...) {
    std::error_code ignored;
    fs::remove(trial, ignored);
    throw;
  }
  std::cout << "wrote " << options.file << " with " << draft.fields.size() << " fields\n";
  say_if_unknown(draft.contacts, "contact", "input.contacts",
                 "--contact-compute (LIGGGHTS) or --contact-lammps (LAMMPS)");
  say_if_unknown(draft.wall_contacts, "wall contact", "input.wall_contacts", "--wall-contact-compute (LIGGGHTS)");
}

}  // namespace

void add_init(CLI::App& app) {
  CLI::App* command = app.add_subcommand("init", "Write a pipeline file that fits dump files");
  const auto options = std::make_shared<InitOptions>();
  InputSpec& input = options->input;
  add_input_options(*command, input);
  command->add_option("--units", input.units, "Unit system, where the dumps name none")->type_name("NAME");
  command->add_option("--density", input.density, "Density of the grains, for dumps without mass")
      ->type_name("DENSITY")
      ->check(positive_number());
  command->add_option("--radius", input.radius, "Radius of all grains, for dumps without sizes")
      ->type_name("LENGTH")
      ->check(positive_number());
  command->add_option("-o,--output", options->file, "The pipeline file to write")
      ->type_name("FILE")
      ->capture_default_str();
  command->footer(init_footer);
  command->callback([options] { init(*options); });
}

}  // namespace grainvdb::cli
