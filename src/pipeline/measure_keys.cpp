#include "pipeline/measure_keys.hpp"

#include "grainvdb/measurement.hpp"
#include "pipeline/option_keys.hpp"
#include "pipeline/species_keys.hpp"

namespace grainvdb {

namespace {

/// Fields of species are named by the pipeline file.
void offer_species(KeyInfo& key, const StageRegistry& registry) {
  for (const Stage& stage : registry.stages())
    if (!stage.species_of.empty() && stage.error_of.empty()) key.choices.push_back(stage.name);
  key.hint = hint_at_species(registry);
  key.name_pattern = pattern_of_species(registry);
}

}  // namespace

void add_measure(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back({"measure", "Tables to make of the frames and fields; a section for each.", false, true});
  for (const MeasurementInfo& measurement : measurement_registry()) {
    const std::string section = "measure." + measurement.name;
    schema.sections.push_back({section, "Measure: " + measurement.description, false, true});
    for (const OptionInfo& option : measurement.options) {
      schema.keys.push_back(option_key(
          section, option, [name = measurement.name](Pipeline& p) -> OptionValues& { return p.measure[name]; }));
      if (option.name == measurement.field_option) offer_species(schema.keys.back(), registry);
    }
  }
}

void check_measure(const Pipeline& pipeline) {
  for (const auto& [name, options] : pipeline.measure) {
    const MeasurementInfo& measurement = *find_measurement(name);
    if (!measurement.conflict) continue;
    if (const auto conflict = measurement.conflict(options))
      throw ConfigError({pipeline.location("measure." + name + '.' + conflict->option),
                         "measure." + name + '.' + conflict->option + " does not fit",
                         conflict->found,
                         conflict->expected,
                         {}});
  }
}

}  // namespace grainvdb
