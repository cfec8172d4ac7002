#include "tune/measured_run.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "pipeline/measure_needs.hpp"
#include "pipeline/run_passes.hpp"

namespace grainvdb {

Lattice checked_lattice_of(const Pipeline& pipeline, const Plan& plan, FrameSource& source) {
  return computed_fields(pipeline).empty() ? check_measure_against_input(pipeline, source)
                                           : check_against_input(pipeline, plan, source);
}

MeasuredRun measured_run(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                         const std::function<void(const Progress&)>& progress) {
  MeasuredRun result{{checked_lattice_of(pipeline, plan, source), {}}};
  std::optional<MeasurePass> measurements;
  if (!pipeline.measure.empty()) measurements.emplace(pipeline, plan, source);
  std::vector<std::unique_ptr<TracerSink>> sinks;
  sinks.push_back(std::make_unique<PathSink>(result.tracers));
  std::optional<TracePass> tracers;
  if (pipeline.trace) tracers.emplace(pipeline, plan, source, sinks);

  RunPasses passes{measurements ? &*measurements : nullptr, tracers ? &*tracers : nullptr};
  passes.fields = [&](OutputFields output) { result.fields.fields = std::move(output.fields); };
  passes.whole_fields = !pipeline.fields.empty() || measures_fields(pipeline);
  RunReport report = make_passes(passes, pipeline, plan, source, progress);
  if (measurements) {
    measurements->commit(report);
    result.tables = std::move(report.tables);
  }
  return result;
}

}  // namespace grainvdb
