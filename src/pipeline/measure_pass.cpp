#include "pipeline/measure_pass.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <tbb/task_arena.h>

#include "base/ordered_pipeline.hpp"
#include "grainvdb/memory_model.hpp"
#include "pipeline/good_frames.hpp"
#include "pipeline/material.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/output_units.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/stream.hpp"
#include "pipeline/wall_domain.hpp"

namespace grainvdb {
namespace {

/// All contacts, and the particles that count as material.
Frame selected(Frame frame, const Pipeline& pipeline) {
  use_forces_of_run(pipeline, frame);
  apply_selection(pipeline.select, frame.box, frame.particles);
  return frame;
}

/// Those in the averages, where there are any.
std::vector<std::size_t> up_to_stop(std::vector<std::size_t> frames, const RunReport& report) {
  if (report.stop) frames.resize(report.stop->frames);
  return frames;
}

bool takes_from(const PlaneRun& run, const std::string& measurement) {
  return std::find(run.measurements.begin(), run.measurements.end(), measurement) != run.measurements.end();
}

/// One entry a frame, with all that is wrong with it: passes that read other columns find other faults.
void add_bad_frames(const std::vector<BadFrame>& more, std::vector<BadFrame>& all) {
  for (const BadFrame& frame : more) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const BadFrame& k) {
      return frame.step ? k.step == frame.step : to_string(k) == to_string(frame);
    });
    if (known == all.end())
      all.push_back(frame);
    else if (known->reason.find(frame.reason) == std::string::npos)
      known->reason += "; " + frame.reason;
  }
}

}  // namespace

MeasurePass::MeasurePass(const Pipeline& pipeline, const Plan& plan, FrameSource& source)
    : pipeline_(pipeline),
      plan_(plan),
      source_(source),
      wanted_(select_frames(pipeline.frames, source.frames().size())),
      lattice_(check_measure_against_input(pipeline, source)),
      plane_runs_(plane_runs(pipeline)) {
  const WallDomain walls = wall_domain(pipeline, source, wanted_);
  for (const MeasurementInfo& info : measurement_registry()) {
    const auto it = pipeline.measure.find(info.name);
    if (it == pipeline.measure.end()) continue;
    const MeasurementSetting setting{it->second,
                                     pipeline.stages,
                                     lattice_,
                                     LucyKernel(pipeline.cutoff > 0 ? pipeline.cutoff : 1),
                                     source.frames()[wanted_.front()].box,
                                     pipeline.input.density,
                                     walls};
    entries_.push_back({info.name, info.needs(it->second), info.make(setting)});
  }
}

void MeasurePass::take(const OutputFields& output) {
  clock_.time("measure", [&] {
    for (const Entry& entry : entries_)
      if (!entry.needs.fields.empty()) entry.measurement->take(output);
  });
}

void MeasurePass::measure(const Frame& frame) {
  // What runs in parallel within a measurement does not begin another frame meanwhile.
  tbb::this_task_arena::isolate([&] {
    clock_.time("measure", [&] {
      for (const Entry& entry : entries_)
        if (entry.needs.particles) entry.measurement->add(frame);
    });
  });
  ++measured_;
}

void MeasurePass::visit_frames(const RunReport& report, const std::function<void(const Progress&)>& progress,
                               const Checkpoint* checkpoint) {
  visit_single_frames(report, progress);
  for (std::size_t n = 0; n < plane_runs_.size(); ++n) visit_planes(n, report, progress, checkpoint);
}

/// As many frames as there are in the averages, where these ended before the last.
void MeasurePass::visit_planes(std::size_t number, const RunReport& report,
                               const std::function<void(const Progress&)>& progress, const Checkpoint* checkpoint) {
  PlaneRun& run = plane_runs_[number];
  set_area(*run.pipeline.planes, source_.frames()[wanted_.front()]);
  if (report.stop) run.pipeline.frames.stop = static_cast<std::int64_t>(wanted_[report.stop->frames - 1]) + 1;
  const auto take = [&](const OutputFields& output) {
    clock_.time("measure", [&] {
      for (const Entry& entry : entries_)
        if (takes_from(run, entry.name)) entry.measurement->take(output);
    });
  };
  GoodFrames source(source_, report.bad_frames);
  std::unique_ptr<Checkpoint> kept;
  if (checkpoint != nullptr)
    kept = checkpoint->of_pass("planes" + std::to_string(number), {{"frames", steps_in_use(report)}});
  const RunReport on_planes = stream_fields(run.pipeline, run.plan, source, take, progress, {}, kept.get());
  measured_ = std::max(measured_, on_planes.frames);
  resumed_on_planes_ += on_planes.resumed_at;
  memory_on_planes_ = std::max(memory_on_planes_, on_planes.memory);
  for (const auto& [step, seconds] : on_planes.seconds) seconds_on_planes_.emplace_back(step + " on planes", seconds);
  std::copy_if(on_planes.bad_frames.begin(), on_planes.bad_frames.end(), std::back_inserter(bad_on_planes_),
               [&](const BadFrame& frame) { return !source.leaves_out(frame); });
}

/// A line each: those that are measured, unless they turn out to be bad.
std::string MeasurePass::steps_in_use(const RunReport& report) const {
  std::string text;
  for (const std::size_t k : without_bad(up_to_stop(wanted_, report), source_, report.bad_frames))
    text += std::to_string(source_.frames()[k].step) + '\n';
  return text;
}

void MeasurePass::visit_single_frames(const RunReport& report, const std::function<void(const Progress&)>& progress) {
  const auto columns = measured_columns(pipeline_);
  if (!columns) return;
  const std::vector<std::size_t> frames = without_bad(up_to_stop(wanted_, report), source_, report.bad_frames);
  Progress now{0, frames.size(), "frames to measure"};
  ordered_pipeline(
      frames.size(), std::max<std::size_t>(1, std::min(frames_in_flight(pipeline_.limits), frames.size())),
      [&](std::size_t i) {
        return clock_.time("read to measure",
                           [&] { return attempt([&] { return source_.read(frames[i], *columns); }); });
      },
      [&](std::size_t, OrFault<Frame> frame) {
        if (!frame.value) return frame;
        return attempt([&] { return selected(std::move(*frame.value), pipeline_); });
      },
      [&](std::size_t i, const OrFault<Frame>& frame) {
        if (frame.value) {
          measure(*frame.value);
        } else {
          if (pipeline_.input.on_error == OnError::error) std::rethrow_exception(frame.fault);
          bad_.add(frames[i], frame.fault);
        }
        ++now.frames_done;
        if (progress) progress(now);
      });
  if (measured_ == 0)
    throw InputError({{source_.frames()[wanted_.front()].file, 0},
                      "every frame is bad, and input.on_error leaves them all out",
                      {},
                      "at least one frame that can be used",
                      {}});
}

void MeasurePass::commit(RunReport& report) {
  clock_.time("measure", [&] {
    for (const Entry& entry : entries_)
      for (Table& table : entry.measurement->tables()) {
        for (const PlaneRun& run : plane_runs_)
          if (takes_from(run, entry.name))
            table.remarks.insert(table.remarks.end(), run.remarks.begin(), run.remarks.end());
        report.tables.push_back(std::move(table));
      }
  });
  const OutputUnits units(source_.units(), pipeline_.reduced);
  for (Table& table : report.tables) units.convert(table);
  add_bad_frames(bad_.list(source_), report.bad_frames);
  add_bad_frames(bad_on_planes_, report.bad_frames);
  report.tables_from = provenance_of(pipeline_, plan_, source_, up_to_stop(wanted_, report), report);
  report.frames = std::max(report.frames, measured_);
  report.resumed_at += resumed_on_planes_;
  report.memory = std::max(report.memory, memory_on_planes_);
  report.seconds.insert(report.seconds.end(), clock_.seconds().begin(), clock_.seconds().end());
  report.seconds.insert(report.seconds.end(), seconds_on_planes_.begin(), seconds_on_planes_.end());
  report.wall_seconds = std::max(report.wall_seconds, clock_.passed());
  report.read = source_.counters();
}

}  // namespace grainvdb
