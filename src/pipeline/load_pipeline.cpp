#include <map>
#include <string>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "grainvdb/pipeline.hpp"
#include "pipeline/half_step_keys.hpp"
#include "pipeline/load_config.hpp"
#include "pipeline/measure_keys.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/reduced_keys.hpp"
#include "pipeline/resolved.hpp"
#include "pipeline/scale_keys.hpp"
#include "pipeline/schema.hpp"
#include "pipeline/species_keys.hpp"
#include "pipeline/species_stages.hpp"
#include "pipeline/trace_schema.hpp"
#include "pipeline/wall_schema.hpp"

namespace grainvdb {
namespace {

void check_box(const Pipeline& p, const std::string& section, const std::optional<std::pair<Vec3, Vec3>>& box) {
  if (!box) return;
  for (std::size_t a = 0; a < 3; ++a)
    if (!(box->first[a] < box->second[a]))
      throw ConfigError({p.location(section), section + " selects nothing along " + "xyz" [a], {}, "lo < hi", {}});
}

void check_until(const Pipeline& p) {
  if (!p.until) return;
  const bool absolute = p.where.contains("average.until.error"), relative = p.where.contains("average.until.relative");
  if (absolute == relative)
    throw ConfigError({p.location("average.until"),
                       absolute ? "the target of average.until is given twice" : "average.until has no target",
                       {},
                       "either average.until.error or average.until.relative",
                       {}});
  if (p.window != 0)
    throw ConfigError({p.location("average.until"),
                       "only one mean of all frames can stop by itself",
                       "average.until at average.window " + std::to_string(p.window),
                       "average.window: all",
                       {}});
}

// Measurements of frames alone have no use for them.
void check_lattice(const Pipeline& p) {
  if (computed_fields(p).empty() && !measures_with_kernel(p)) return;
  const auto require = [&](const std::string& section, double value, const char* expected) {
    if (value == 0) throw ConfigError({Location{p.file}, "the section '" + section + "' is missing", {}, expected, {}});
  };
  require("lattice", p.voxel, "lattice.voxel");
  require("kernel", p.cutoff, "kernel.cutoff");
}

/// input.contacts.lammps stands for columns.
void check_lammps_contacts(const Pipeline& p) {
  if (!p.where.contains("input.contacts.lammps")) return;
  for (const char* other : {"input.contacts.columns", "input.contacts.compute"})
    if (p.where.contains(other))
      throw ConfigError({p.location(other),
                         "the columns of the contact dumps are described twice",
                         std::string(other) + " beside input.contacts.lammps",
                         "one of them",
                         {}});
}

/// What `section` says of the columns of contact dumps.
void check_columns_of(const Pipeline& p, const std::string& section, const std::string& noun,
                      const std::vector<std::string>& compute,
                      const std::map<std::string, std::vector<std::string>>& columns) {
  if (!compute.empty() && !columns.empty())
    throw ConfigError({p.location(section),
                       "the columns of the " + noun + " dumps are described twice",
                       {},
                       "either " + section + ".compute or " + section + ".columns",
                       {}});
  const auto has = [&](const char* name) { return columns.contains(name); };
  const bool parts = has("normal_force") && has("tangential_force"),
             one_part = has("normal_force") || has("tangential_force");
  if (!columns.empty() && (has("force") ? one_part : !parts))
    throw ConfigError({p.location(section + ".columns"),
                       "the contact force must be given in one way",
                       {},
                       "either force (the total), or both normal_force and tangential_force",
                       {}});
}

// What no single key can tell.
void check_together(const Pipeline& p, const Schema& schema) {
  check_output(p, schema);
  if (p.fields.empty() && !p.trace && p.measure.empty())
    throw ConfigError({Location{p.file},
                       "the section 'output' is missing",
                       {},
                       "output, with the fields to write, trace, with the seeds of tracers, or measure",
                       {}});
  check_trace(p);
  check_measure(p);
  check_lattice(p);
  check_lammps_contacts(p);
  check_columns_of(p, "input.contacts", "contact", p.input.contacts.compute, p.input.contacts.columns);
  check_columns_of(p, "input.wall_contacts", "wall contact", p.input.wall_contacts.compute,
                   p.input.wall_contacts.columns);
  check_half_step(p);
  if (p.window_step > 0 && p.window == 0)
    throw ConfigError({p.location("average.step"), "average.step has no meaning for one mean of all frames",
                       "average.step " + std::to_string(p.window_step) + " at average.window all",
                       "average.window: none, or a number of frames",
                       "frames: ::" + std::to_string(p.window_step) + " averages every so many frames"});
  check_until(p);
  if (const auto& ids = p.select.ids; ids && ids->first > ids->second)
    throw ConfigError({p.location("select.ids"),
                       "select.ids selects nothing",
                       '[' + std::to_string(ids->first) + ", " + std::to_string(ids->second) + ']',
                       "the first id, then the last",
                       {}});
  check_box(p, "select.region", p.select.region);
  check_box(p, "region", p.region);
  check_species(p);
  check_walls(p);
}

}  // namespace

std::string key_of_fields(const Pipeline& pipeline) {
  return pipeline.planes ? "measure" : "output.fields";
}

std::vector<std::string> computed_fields(const Pipeline& pipeline) {
  std::vector<std::string> all = pipeline.fields;
  const auto need = [&](const std::string& name) {
    if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
  };
  for (const auto& [name, options] : pipeline.measure)
    for (const std::string& field : find_measurement(name)->needs(options).fields) need(field);
  if (!pipeline.trace) return all;
  need("velocity");
  if (pipeline.trace->strain) need("shear_rate");
  for (const std::string& name : pipeline.trace->record) need(name);
  return all;
}

Location Pipeline::location(const std::string& key) const {
  const auto it = where.find(key);
  return it == where.end() ? Location{file, 0} : it->second;
}

Pipeline load_pipeline(const std::string& file, const std::vector<std::string>& overrides,
                       const StageRegistry& registry) {
  const Schema without_species = make_schema(registry);
  const ConfigNode root = read_with_overrides(file, overrides, without_species);
  const Schema schema = make_schema(with_species(registry, with_species_of(root, file, without_species)));
  CheckedConfig config = check_config(root, file, schema);
  if (!config.values.contains("output.fields")) config.values.erase("output.formats");

  Pipeline pipeline;
  pipeline.file = file;
  pipeline.stages = registry.default_settings();
  for (const KeyInfo& key : schema.keys)
    if (const auto it = config.values.find(key.path()); it != config.values.end()) key.apply(pipeline, it->second);
  pipeline.where = config.places;
  for (const auto& [key, place] : pipeline.where)
    if (key.starts_with("input.")) pipeline.input.where.emplace(key, place);
  if (auto& half_step = pipeline.input.contacts.half_step; half_step && half_step->dt == 0)
    half_step->dt = pipeline.input.dt.value_or(0);
  check_together(pipeline, schema);
  check_reduced(pipeline, registry);
  // A result is at one scale, and says which.
  std::map<std::string, ConfigValue> values = config.values;
  std::erase_if(values, [](const auto& entry) { return entry.first.starts_with("scales."); });
  complete_scales(pipeline, schema, values);
  pipeline.resolved = resolved_yaml(schema, values);
  return pipeline;
}

}  // namespace grainvdb
