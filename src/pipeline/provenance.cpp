#include "pipeline/provenance.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "grainvdb/kernel.hpp"
#include "grainvdb/measurement.hpp"
#include "grainvdb/version.hpp"
#include "pipeline/bad_frames.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/number.hpp"
#include "pipeline/output_units.hpp"
#include "pipeline/spot_input.hpp"

namespace grainvdb {
namespace {

template <class Range, class F>
std::string lines(const Range& range, F&& line) {
  std::string text;
  for (const auto& item : range) text += line(item) + "\n";
  return text;
}

}  // namespace

Provenance provenance_of(const Pipeline& pipeline, const Plan& plan, const FrameSource& source,
                         std::span<const std::size_t> frames, const RunReport& report) {
  const auto plain = [](const auto& s) { return s; };
  std::vector<std::size_t> skipped;
  for (std::size_t k = 0; k < source.frames().size(); ++k)
    if (!std::binary_search(frames.begin(), frames.end(), k)) skipped.push_back(k);
  const std::vector<std::size_t> averaged = without_bad({frames.begin(), frames.end()}, source, report.bad_frames);
  const auto step = [&](std::size_t k) { return std::to_string(source.frames()[k].step); };
  std::vector<std::string> columns = column_names(columns_read(plan, pipeline));
  std::sort(columns.begin(), columns.end());
  Provenance all = key_of_run(pipeline, source);
  all.insert(all.end(),
             {{"units", source.units().name},
              {"steps", lines(averaged, step)},
              {"skipped_frames", lines(skipped, step)},
              {"bad_frames", lines(report.bad_frames, [](const BadFrame& frame) { return to_string(frame); })},
              {"averaging", lines(report.averaging, plain)},
              {"walls", lines(report.walls, plain)},
              {"columns_read", lines(columns, plain)},
              {"computed", lines(plan.stages, [](const Stage* s) { return s->name + ": " + s->equation; })},
              {"not_needed", lines(plan.not_needed, plain)}});
  if (is_spot_run(source)) all.emplace_back("snapshots", spot_snapshots);
  if (pipeline.reduced) all.emplace_back("reduced_units", OutputUnits(source.units(), pipeline.reduced).scales());
  if (!plan.stages.empty())
    all.emplace_back("grain_volume_error", print_number(grain_volume_error(pipeline.cutoff / pipeline.voxel)));
  if (!pipeline.measure.empty())
    all.emplace_back("measured", lines(pipeline.measure, [](const auto& entry) {
                       const MeasurementInfo& info = *find_measurement(entry.first);
                       return info.name + ": " + info.equation;
                     }));
  return all;
}

std::vector<std::pair<std::string, std::string>> key_of_run(const Pipeline& pipeline, const FrameSource& source) {
  auto key = key_of_run(pipeline);
  key.emplace_back("inputs",
                   lines(source.files(), [](const auto& f) { return f.first + " " + std::to_string(f.second); }));
  return key;
}

std::vector<std::pair<std::string, std::string>> key_of_run(const Pipeline& pipeline) {
  return {{"version", GRAINVDB_VERSION}, {"pipeline", pipeline.resolved}};
}

}  // namespace grainvdb
