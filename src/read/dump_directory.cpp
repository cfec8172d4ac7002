#include "read/dump_directory.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/listed.hpp"
#include "read/columns.hpp"
#include "read/contact_table.hpp"
#include "read/particle_table.hpp"
#include "read/text.hpp"
#include "read/unsaid.hpp"
#include "read/wall_contact_table.hpp"

namespace grainvdb {
namespace {

/// What stands for the units when neither the dump nor the pipeline file names them: a field then says what it is, not
/// in what.
UnitSystem unnamed_units() {
  return {"unspecified", "mass", "length", "time"};
}

std::string known_units() {
  return listed(unit_systems(), &UnitSystem::name);
}

const UnitSystem& unit_system_in_dump(const Stated& stated) {
  const UnitSystem* system = find_unit_system(stated.text);
  if (system == nullptr)
    throw InputError({stated.where, "the units are not supported", in_quotes(stated.text), known_units(),
                      "In other unit systems of LAMMPS a stress is not mass/(length time²)"});
  return *system;
}

UnitSystem choose_units(const InputSpec& spec, const std::optional<Stated>& stated) {
  const UnitSystem* wanted = spec.units ? find_unit_system(*spec.units) : nullptr;
  if (spec.units && wanted == nullptr)
    throw ConfigError({stated_at(spec, "input.units"), "unknown units", *spec.units, known_units(), {}});
  if (!stated) return wanted != nullptr ? *wanted : unnamed_units();
  const UnitSystem& found = unit_system_in_dump(*stated);
  if (wanted != nullptr && wanted->name != found.name) {
    const std::string at = to_string(stated_at(spec, "input.units"));
    throw InputError({stated->where,
                      "the units are not those of the pipeline file",
                      found.name,
                      wanted->name + (at.empty() ? ", as input.units says" : ", as in " + at),
                      {}});
  }
  return found;
}

void check_positive(const InputSpec& spec, const std::string& key, const std::optional<double>& value) {
  if (value && !(*value > 0 && std::isfinite(*value)))
    throw ConfigError({stated_at(spec, "input." + key),
                       "input." + key + " is out of range",
                       std::to_string(*value),
                       "a finite number above 0",
                       {}});
}

/// Takes files out that were met in a directory but are known to belong elsewhere.
void leave_out(std::vector<InputFile>& files, const std::set<FileIdentity>& elsewhere) {
  std::erase_if(files, [&](const InputFile& file) { return !file.named && elsewhere.contains(file.identity); });
}

std::set<FileIdentity> named(const std::vector<InputFile>& files) {
  std::set<FileIdentity> result;
  for (const InputFile& file : files)
    if (file.named) result.insert(file.identity);
  return result;
}

/// Files may print times with six digits.
bool same_time(double a, double b) {
  constexpr double printed = 2e-6;
  return std::abs(a - b) <= printed * std::max(std::abs(a), std::abs(b));
}

std::string in_quotes(const std::vector<std::string>& patterns) {
  return listed(patterns, [](const std::string& pattern) { return "'" + pattern + "'"; });
}

}  // namespace

void check_spec(const InputSpec& spec) {
  check_positive(spec, "dt", spec.dt);
  check_positive(spec, "density", spec.density);
  check_positive(spec, "radius", spec.radius);
  check_box(spec);
  check_contact_spec(spec);
  check_wall_contact_spec(spec);
}

InputFiles find_files(const InputSpec& spec) {
  InputFiles files{list_files(spec.particles, stated_at(spec, "input.particles")),
                   list_files(spec.contacts.files, stated_at(spec, "input.contacts.files")),
                   list_files(spec.wall_contacts.files, stated_at(spec, "input.wall_contacts.files"))};
  // So that a directory is not searched for what a glob has named as dumps of another kind.
  const std::set<FileIdentity> contacts = named(files.contacts), wall_contacts = named(files.wall_contacts);
  leave_out(files.particles, contacts);
  leave_out(files.particles, wall_contacts);
  leave_out(files.contacts, wall_contacts);
  leave_out(files.wall_contacts, contacts);
  return files;
}

DumpDirectory::DumpDirectory(const InputSpec& spec, InputFiles files)
    : spec_(spec), particles_(std::move(files.particles), RowKind::particles, spec_, counters_) {
  particles_.build_index();
  if (particles_.frames().empty())
    throw InputError(
        {stated_at(spec, "input.particles"),
         spec.particles.empty() ? "no particle dumps are given" : "no particle dump in " + in_quotes(spec.particles),
         particles_.unreadable().empty() ? std::string() : particles_.unreadable().front().reason,
         "paths, directories or globs of particle dumps",
         {}});
  std::set<FileIdentity> particle_files;
  for (const InputFile& file : particles_.files()) particle_files.insert(file.identity);
  leave_out(files.contacts, particle_files);
  leave_out(files.wall_contacts, particle_files);
  contacts_.emplace(std::move(files.contacts), RowKind::contacts, spec_, counters_);
  wall_contacts_.emplace(std::move(files.wall_contacts), RowKind::wall_contacts, spec_, counters_);

  units_ = choose_units(spec, particles_.units());
  for (const FrameRecord& record : particles_.frames()) {
    FrameInfo& info = frames_.emplace_back();
    info.file = particles_.files()[record.file].path;
    info.index_in_file = record.index_in_file;
    info.step = record.step;
    info.time = record.time;
    if (!info.time && spec.dt) info.time = static_cast<double>(record.step) * *spec.dt;
    info.particle_count = record.rows;
    info.box = record.box;
  }
}

std::vector<std::pair<std::string, std::uintmax_t>> DumpDirectory::files() const {
  std::vector<std::pair<std::string, std::uintmax_t>> all;
  std::set<FileIdentity> met;  // contacts of both sorts may be in one file
  for (const DumpSeries* series : {&particles_, &*contacts_, &*wall_contacts_})
    for (const InputFile& file : series->files())
      if (met.insert(file.identity).second) all.emplace_back(file.path, file.size);
  return all;
}

std::vector<BadFrame> DumpDirectory::unreadable() const {
  std::vector<BadFrame> all = particles_.unreadable();
  for (const DumpSeries* series : {&*contacts_, &*wall_contacts_})
    all.insert(all.end(), series->unreadable().begin(), series->unreadable().end());
  return all;
}

void DumpDirectory::require(std::size_t k, ColumnSet wanted) {
  particle_layout(particles_.header(particles_.frames().at(k)), frames_[k].file, spec_, wanted);
  const auto layout_beside = [&](const Beside& dumps, auto make_layout) {
    const FrameRecord& record = dumps.series.frames()[find_beside(k, dumps)];
    make_layout(dumps.series.header(record), dumps.series.files()[record.file].path, spec_);
  };
  if (wanted.has(Column::contacts)) layout_beside(contacts(), contact_layout);
  if (wanted.has(Column::wall_contacts)) layout_beside(wall_contacts(), wall_contact_layout);
}

Frame DumpDirectory::read(std::size_t k, ColumnSet wanted) {
  const FrameInfo& info = frames_.at(k);
  const FrameHeader& header = particles_.go_to(k);
  const ParticleLayout layout = particle_layout(header, info.file, spec_, wanted);
  Frame frame;
  frame.file = info.file;
  frame.step = info.step;
  frame.time = info.time;
  frame.box = info.box;
  frame.particles = make_particles(layout, particles_.read_rows(layout.request), header, info.file);
  if (wanted.has(Column::contacts)) frame.contacts = read_contacts(k);
  if (wanted.has(Column::wall_contacts)) frame.wall_contacts = read_wall_contacts(k, frame.particles.id);
  ++counters_.frames_read;
  return frame;
}

/// The frame of such dumps of a step. The first call indexes them.
std::size_t DumpDirectory::find_beside(std::size_t frame, const Beside& dumps) {
  const FrameRecord& particles = particles_.frames()[frame];
  const std::int64_t step = particles.step;
  const std::string key = dumps.section + ".files";
  const Location where = stated_at(spec_, key);
  if (dumps.patterns.empty())
    throw InputError({where,
                      dumps.noun + "s are needed but no " + dumps.noun + " dumps are given",
                      {},
                      key,
                      "Name the " + dumps.noun + " dumps in the pipeline file"});
  DumpSeries& series = dumps.series;
  series.build_index();
  if (series.units() && find_unit_system(units_.name) != nullptr && series.units()->text != units_.name)
    throw InputError({series.units()->where,
                      "the units are not those of the particle dumps",
                      in_quotes(series.units()->text),
                      units_.name,
                      {}});
  const std::optional<std::size_t> k = series.find(step);
  if (!k)
    throw InputError({where, "no " + dumps.noun + " dump has timestep " + std::to_string(step),
                      std::to_string(series.frames().size()) + " other timesteps in the " +
                          std::to_string(series.files().size()) + ' ' + dumps.noun + " files of " +
                          in_quotes(dumps.patterns),
                      "one " + dumps.noun + " frame for every particle frame that is used",
                      "Choose the frames that have " + dumps.noun + "s, or fields that need none"});
  const FrameRecord& found = series.frames()[*k];
  if (particles.time && found.time && !same_time(*particles.time, *found.time))
    throw InputError(
        {{series.files()[found.file].path, found.start.line},
         "the " + dumps.noun + "s of timestep " + std::to_string(step) + " are of another time than its particles",
         std::to_string(*found.time),
         std::to_string(*particles.time),
         "Particles and contacts have to be written at the same times"});
  return *k;
}

Contacts DumpDirectory::read_contacts(std::size_t frame) {
  const std::size_t k = find_beside(frame, contacts());
  const FrameHeader& header = contacts_->go_to(k);
  const std::string& file = contacts_->files()[contacts_->frames()[k].file].path;
  const ContactLayout layout = contact_layout(header, file, spec_);
  return make_contacts(layout, contacts_->read_rows(layout.request), header, file);
}

WallContacts DumpDirectory::read_wall_contacts(std::size_t frame, const std::vector<std::int64_t>& ids) {
  const std::size_t k = find_beside(frame, wall_contacts());
  const FrameHeader& header = wall_contacts_->go_to(k);
  const std::string& file = wall_contacts_->files()[wall_contacts_->frames()[k].file].path;
  const WallContactLayout layout = wall_contact_layout(header, file, spec_);
  return make_wall_contacts(layout, wall_contacts_->read_rows(layout.request), header, file, ids);
}

void DumpDirectory::keep_frames_with_contacts() {
  for (const Beside& dumps : {contacts(), wall_contacts()}) {
    if (dumps.patterns.empty()) continue;
    dumps.series.build_index();
    const auto first_without = std::find_if(frames_.begin(), frames_.end(),
                                            [&](const FrameInfo& frame) { return !dumps.series.find(frame.step); });
    frames_.erase(first_without, frames_.end());
  }
}

void DumpDirectory::keep_frames_up_to(std::int64_t step) {
  std::erase_if(frames_, [&](const FrameInfo& frame) { return frame.step > step; });
}

std::vector<FileIdentity> DumpDirectory::whole_files() const {
  std::vector<FileIdentity> all = particles_.whole_files();
  for (const DumpSeries* series : {&*contacts_, &*wall_contacts_})
    all.insert(all.end(), series->whole_files().begin(), series->whole_files().end());
  return all;
}

void DumpDirectory::require_no_fault() const {
  for (const DumpSeries* series : {&particles_, &*contacts_, &*wall_contacts_})
    if (series->fault()) std::rethrow_exception(series->fault());
}

std::unique_ptr<FrameSource> open_dumps(const InputSpec& spec) {
  check_spec(spec);
  return std::make_unique<DumpDirectory>(spec, find_files(spec));
}

}  // namespace grainvdb
