#include "pipeline/reduced_keys.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "grainvdb/error.hpp"
#include "pipeline/key_builders.hpp"
#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

KeyInfo part_of_units(const char* name, const char* unit, const char* help, double ReducedUnits::*part) {
  KeyInfo key = number_key("output.reduced", name, unit, help, [part](Pipeline& p, const ConfigValue& v) {
    if (!p.reduced) p.reduced.emplace();
    (*p.reduced).*part = std::get<double>(v);
  });
  key.required = true;
  return key;
}

}  // namespace

void add_reduced_keys(Schema& schema) {
  schema.sections.push_back({"output.reduced",
                             "Writes all results, tracers and tables too, in units of d (length), sqrt(d/g) (time) and "
                             "rho_p d^3 (mass), which are given here in those of the dump. Everything else in this "
                             "file stays in the units of the dump."});
  schema.keys.push_back(part_of_units("diameter", "length", "d, of the grains.", &ReducedUnits::diameter));
  schema.keys.push_back(part_of_units("gravity", "length/time^2", "g.", &ReducedUnits::gravity));
  schema.keys.push_back(
      part_of_units("density", "mass/length^3", "rho_p, of the grains, not of the packing.", &ReducedUnits::density));
}

void check_reduced(const Pipeline& pipeline, const StageRegistry& registry) {
  if (!pipeline.reduced) return;
  std::vector<Dimension> quantities{dimension::length, dimension::time, dimension::mass};
  for (const Stage& stage : registry.stages()) quantities.push_back(stage.dimension);
  for (const Dimension& quantity : quantities) {
    const double size = pipeline.reduced->size(quantity);
    if (!std::isnormal(static_cast<float>(size)))
      throw ConfigError({pipeline.location("output.reduced"), "a unit of output.reduced is out of the range of numbers",
                         ReducedUnits::symbol(quantity) + " = " + print_number(size),
                         "units from 1.2e-38 to 3.4e38 in those of the dump", no_unit_hint});
  }
}

void check_output(const Pipeline& pipeline, const Schema& schema) {
  if (!pipeline.where.contains("output") || pipeline.where.contains("output.fields")) return;
  const bool units_alone = pipeline.reduced && !pipeline.where.contains("output.formats");
  if (units_alone && (pipeline.trace || !pipeline.measure.empty())) return;
  throw ConfigError({pipeline.location("output"),
                     "the key 'output.fields' is missing",
                     {},
                     accepted(*schema.find_key("output", "fields")),
                     {}});
}

}  // namespace grainvdb
