#include "cli/dry_run.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "grainvdb/memory_model.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/topology.hpp"
#include "pipeline/number.hpp"
#include "pipeline/plane_runs.hpp"
#include "pipeline/unless_bad.hpp"

namespace grainvdb::cli {
namespace {

/// Frame k alone. There are no standard errors of one frame, and nobody is to wait for tracers.
Pipeline of_frame(const Pipeline& pipeline, std::size_t k) {
  Pipeline one = pipeline;
  one.fields = computed_fields(pipeline);
  std::erase_if(one.fields, [](const std::string& name) { return name.ends_with("_error"); });
  one.trace.reset();
  one.measure.clear();
  one.until.reset();
  one.window = one.window_step = 0;
  const auto first = static_cast<std::int64_t>(k);
  one.frames = {first, first + 1, 1};
  one.input.on_error = OnError::error;
  return one;
}

std::string time_text(double seconds) {
  return seconds < 120 ? short_number(seconds) + " s" : short_number(seconds / 60) + " min";
}

RunReport compute(const Pipeline& pipeline, FrameSource& source) {
  return compute_fields(pipeline, make_plan(pipeline), source, [](const OutputFields&) {});
}

/// By the first of these frames that can be used; `what` is said of it.
std::string estimate_pass(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                          const std::vector<std::size_t>& frames, const std::string& what) {
  const Lattice lattice = check_against_input(pipeline, plan, source);
  check_trace_against_input(pipeline, source);
  std::size_t used = 0;
  std::optional<RunReport> report;
  const std::size_t rows_before = source.counters().rows_read;
  for (const std::size_t k : frames) {
    report = unless_bad(pipeline.input, [&] { return compute(of_frame(pipeline, k), source); });
    used = k;
    if (report) break;
  }
  if (!report) return "no frame of these can be used\n";
  RunSize size;
  size.particles = static_cast<double>(source.frames()[used].particle_count);
  size.contacts = std::max(0.0, static_cast<double>(report->read.rows_read - rows_before) - size.particles);
  size.images = images_per_particle(lattice, pipeline);
  size.voxels = static_cast<double>(report->summed_leaves) * leaf_size;
  const double seconds = report->wall_seconds;
  return "step " + std::to_string(source.frames()[used].step) + " alone: " + what + short_number(seconds) + " s, " +
         std::to_string(report->active_voxels) + (pipeline.planes ? " planes" : " active voxels") +
         "\nall frames: " + what + "about " + time_text(seconds * static_cast<double>(frames.size())) +
         " or less, as steps overlap, and " + short_number(memory_model(plan, pipeline).peak(size) / 1e6) +
         " MB by the formula of 'grainvdb graph', if all are like it\n";
}

}  // namespace

std::string estimate(const Pipeline& pipeline, const Plan& plan, FrameSource& source) {
  if (!pipeline.measure.empty()) check_measure_against_input(pipeline, source);
  const std::vector<std::size_t> frames = select_frames(pipeline.frames, source.frames().size());
  std::string text =
      "would use " + std::to_string(frames.size()) + " of " + std::to_string(source.frames().size()) + " frames\n";
  if (!plan.stages.empty()) text += estimate_pass(pipeline, plan, source, frames, {});
  for (PlaneRun& run : plane_runs(pipeline)) {
    set_area(*run.pipeline.planes, source.frames()[frames.front()]);
    text += estimate_pass(run.pipeline, run.plan, source, frames, "averages over planes, ");
  }
  return text;
}

}  // namespace grainvdb::cli
