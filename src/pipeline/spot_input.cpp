#include "pipeline/spot_input.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "base/listed.hpp"
#include "grainvdb/measurement.hpp"

namespace grainvdb {
namespace {

/// Of each stage of a plan, whether it or one that it needs is made of forces.
std::map<std::string, bool> made_of_forces(const Pipeline& pipeline, const Plan& plan) {
  std::map<std::string, bool> found;
  for (const Stage* stage : plan.stages) {  // needs come first
    bool& of_forces = found[stage->name] = stage->of_forces;
    if (!stage->needs) continue;
    for (const std::string& need : stage->needs(pipeline.stages).fields) of_forces = of_forces || found[need];
  }
  return found;
}

[[noreturn]] void refuse(const Location& where, const std::string& what, const FrameSource& source,
                         const std::string& hint) {
  throw ConfigError({where, what, std::string("column ") + spot_column + " in " + source.frames().front().file,
                     "dumps of a simulation with forces", hint});
}

}  // namespace

bool is_spot_run(const FrameSource& source) {
  const auto& columns = source.particle_columns();
  return std::find(columns.begin(), columns.end(), spot_column) != columns.end();
}

void refuse_forces_of_spots(const Pipeline& pipeline, const Plan& plan, const FrameSource& source) {
  if (!is_spot_run(source)) return;
  const std::map<std::string, bool> of_forces = made_of_forces(pipeline, plan);
  const auto refuse_among = [&](const std::vector<std::string>& fields, const std::string& key) {
    std::vector<std::string> refused;
    std::copy_if(fields.begin(), fields.end(), std::back_inserter(refused), [&](const std::string& field) {
      const auto it = of_forces.find(field);
      return it != of_forces.end() && it->second;
    });
    if (refused.empty()) return;
    refuse(
        pipeline.location(key),
        "there are no forces in a spot run, and so neither stress nor what is made of it: " + key + " wants " +
            listed(refused) +
            ". The spot model moves grains by geometry alone; the velocities in its dumps are displacements over the "
            "time between two",
        source, "Leave these out; phi, velocity and shear_rate are there, and all of the packing");
  };
  refuse_among(pipeline.fields, key_of_fields(pipeline));
  for (const auto& [name, options] : pipeline.measure)
    refuse_among(find_measurement(name)->needs(options).fields, "measure." + name);
  if (pipeline.trace) refuse_among(pipeline.trace->record, "trace.record");
  if (pipeline.until) refuse_among({pipeline.until->field}, "average.until.field");
}

void refuse_contacts_of_spots(const Pipeline& pipeline, const FrameSource& source) {
  if (!is_spot_run(source)) return;
  for (const auto& [name, options] : pipeline.measure) {
    const auto columns = find_measurement(name)->needs(options).particles;
    if (columns && columns->has(Column::contacts))
      refuse(pipeline.location("measure." + name),
             "measure." + name + " wants the contacts of a simulation, and a spot run has none", source,
             "Grains that touch are found by their distance: contacts: gap");
  }
}

}  // namespace grainvdb
