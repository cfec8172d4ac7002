#include "pipeline/average_keys.hpp"

#include <cstdint>
#include <string>

#include "pipeline/species_keys.hpp"

namespace grainvdb {
namespace {

Until& until_of(Pipeline& p) {
  return p.until ? *p.until : p.until.emplace();
}

void add_until_keys(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back({"average.until",
                             "Ends the average, of all frames, once a standard error is small enough; give error or "
                             "relative."});
  KeyInfo field{"average.until", "field", ValueType::text, "The field whose standard error it is."};
  field.required = true;
  for (const Stage& stage : registry.stages())
    if (!stage.error_of.empty()) field.choices.push_back(stage.error_of);
  field.hint = hint_at_species(registry);
  field.name_pattern = pattern_of_species(registry);
  field.apply = [](Pipeline& p, const ConfigValue& v) { until_of(p).field = std::get<std::string>(v); };
  schema.keys.push_back(field);
  const auto add_target = [&](const char* name, const char* help, const char* unit, bool relative) {
    KeyInfo target{"average.until", name, ValueType::number, help, unit};
    target.minimum = 0;
    target.above_minimum = true;
    target.apply = [relative](Pipeline& p, const ConfigValue& v) {
      until_of(p).error = std::get<double>(v);
      until_of(p).relative = relative;
    };
    schema.keys.push_back(target);
  };
  add_target("error", "The standard error that is small enough; vectors and tensors count by their magnitude.",
             "unit of the field", false);
  add_target("relative", "The same as a part of the magnitude of the field.", "", true);
  KeyInfo quantile{"average.until", "quantile", ValueType::number,
                   "The share of voxels, among those where the field has a value, in which it must be."};
  quantile.required = true;
  quantile.minimum = 0;
  quantile.above_minimum = true;
  quantile.maximum = 1;
  quantile.apply = [](Pipeline& p, const ConfigValue& v) { until_of(p).quantile = std::get<double>(v); };
  schema.keys.push_back(quantile);
}

}  // namespace

void add_average_keys(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back({"average", "Averages over time."});
  KeyInfo window{"average", "window", ValueType::window,
                 "Frames per output time; 'all' makes one mean of all frames, 'none' an output time of each frame. The "
                 "last output time may have fewer."};
  window.default_value = std::string("all");
  window.minimum = 1;
  window.apply = [](Pipeline& p, const ConfigValue& v) {
    const auto* count = std::get_if<std::int64_t>(&v);
    p.window = count != nullptr ? static_cast<std::size_t>(*count) : std::get<std::string>(v) == "none" ? 1 : 0;
  };
  schema.keys.push_back(window);
  KeyInfo step{"average", "step", ValueType::integer,
               "Frames from the beginning of one output time to that of the next; as many as average.window unless "
               "given. Fewer make windows that slide, more leave out the frames in between."};
  step.minimum = 1;
  step.apply = [](Pipeline& p, const ConfigValue& v) {
    p.window_step = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(step);
  KeyInfo blocks{"average", "blocks", ValueType::integer,
                 "Blocks of successive frames that each output time is divided into for standard errors (the fields "
                 "NAME_error), which hold where a block is longer than motion is correlated. B blocks give an error "
                 "to 1 part in sqrt(2(B-1))."};
  blocks.default_value = static_cast<std::int64_t>(Pipeline().blocks);
  blocks.minimum = 2;
  blocks.maximum = 1000;
  blocks.apply = [](Pipeline& p, const ConfigValue& v) {
    p.blocks = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(blocks);
  add_until_keys(schema, registry);
}

}  // namespace grainvdb
