#include "pipeline/scale_keys.hpp"

#include <algorithm>
#include <utility>

#include "grainvdb/error.hpp"
#include "pipeline/resolved.hpp"

namespace grainvdb {
namespace {

void add_list(Schema& schema, const char* name, const char* help, double Scale::*number) {
  KeyInfo key{"scales", name, ValueType::numbers, help, "length"};
  key.required = true;
  key.minimum = 0;
  key.above_minimum = true;
  key.most = 100;
  key.apply = [number](Pipeline& p, const ConfigValue& v) {
    const auto& values = std::get<std::vector<double>>(v);
    p.scales.resize(std::max(p.scales.size(), values.size()));
    for (std::size_t k = 0; k < values.size(); ++k) p.scales[k].*number = values[k];
  };
  schema.keys.push_back(key);
}

}  // namespace

void add_scale_keys(Schema& schema) {
  schema.sections.push_back(
      {"scales",
       "Several cutoffs with their voxels, computed in one pass over the dumps, each into a folder "
       "of its own; they take the places of kernel.cutoff and lattice.voxel."});
  add_list(schema, "cutoff", "Cutoffs.", &Scale::cutoff);
  add_list(schema, "voxel", "Voxels, as many as cutoffs.", &Scale::voxel);
}

void complete_scales(Pipeline& pipeline, const Schema& schema, std::map<std::string, ConfigValue> values) {
  if (!pipeline.scales.empty() && pipeline.until)
    throw ConfigError({pipeline.location("scales"),
                       "scales would end their averages at different frames",
                       "both scales and average.until",
                       "one of them",
                       {}});
  if (!pipeline.scales.empty() && pipeline.trace && pipeline.trace->neighbourhood == TraceSpec::Neighbourhood::always)
    throw ConfigError({pipeline.location("trace.neighbourhood"),
                       "passes around tracers alone would read frames at different times at each scale",
                       "both scales and trace.neighbourhood: always",
                       "one of them",
                       {}});
  for (std::size_t k = 0; k < pipeline.scales.size(); ++k) {
    Scale& scale = pipeline.scales[k];
    if (scale.cutoff == 0 || scale.voxel == 0)
      throw ConfigError({pipeline.location("scales"),
                         "scales.cutoff and scales.voxel do not make pairs",
                         std::to_string(k) + (scale.cutoff == 0 ? " cutoffs" : " voxels") + " for " +
                             std::to_string(pipeline.scales.size()) + (scale.cutoff == 0 ? " voxels" : " cutoffs"),
                         "as many voxels as cutoffs",
                         {}});
    for (std::size_t other = 0; other < k; ++other)
      if (pipeline.scales[other].cutoff == scale.cutoff && pipeline.scales[other].voxel == scale.voxel)
        throw ConfigError({pipeline.location("scales"), "scales names a pair twice", {}, "each pair once", {}});
    values["kernel.cutoff"] = scale.cutoff;
    values["lattice.voxel"] = scale.voxel;
    scale.resolved = resolved_yaml(schema, values);
  }
}

}  // namespace grainvdb
