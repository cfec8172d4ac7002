#include "grainvdb/run.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include <tbb/task_group.h>

#include "base/parallel.hpp"
#include "pipeline/measure_needs.hpp"
#include "pipeline/measure_pass.hpp"
#include "pipeline/output_units.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/run_into.hpp"
#include "pipeline/run_passes.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/trace_pass.hpp"
#include "pipeline/written_box.hpp"

namespace grainvdb {
namespace {

using Sinks = std::vector<std::unique_ptr<FieldSink>>;

/// Writes one output time while the next is computed.
class Writer {
 public:
  /// Refuses, before anything is read, a series whose box has too many voxels (LimitError).
  Writer(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const Sinks& sinks);

  /// Begins to write. Before it, waits for the output time before, and throws what its writing threw.
  void take(OutputFields output);
  /// Waits for the last output time, and throws what its writing threw. Must be called before the writer goes.
  void finish() { behind_.wait(); }
  /// Puts the results under their names.
  void commit(RunReport& report);

 private:
  void write(OutputFields& output);
  void convert(OutputFields& output) const;
  OutputLayout layout(const Topology::Bounds& bounds, const std::vector<const SparseField*>& fields) const;
  bool writes_mask() const;

  const Pipeline& pipeline_;
  const Plan& plan_;
  FrameSource& source_;
  const Sinks& sinks_;
  Lattice lattice_;
  OutputUnits units_;
  Lattice written_lattice_;
  bool has_time_;
  std::vector<std::size_t> wanted_;
  WindowSchedule schedule_;
  std::optional<Topology::Bounds> series_box_;
  bool begun_ = false;
  Stopwatch clock_;
  std::mutex turn_;  // no call ever waits: the thread sanitizer does not see TBB's own hand-over
  // Else the tasks would be those of the pipeline that hands over the first output time, which ends before them.
  tbb::task_group_context apart_{tbb::task_group_context::isolated};
  tbb::task_group behind_{apart_};
};

Writer::Writer(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const Sinks& sinks)
    : pipeline_(pipeline),
      plan_(plan),
      source_(source),
      sinks_(sinks),
      lattice_(check_against_input(pipeline, plan, source)),
      units_(source.units(), pipeline.reduced),
      written_lattice_(units_.converted(lattice_)),
      has_time_(source.frames().front().time.has_value()),
      wanted_(select_frames(pipeline.frames, source.frames().size())),
      schedule_(schedule_windows(time_windows(pipeline, plan), wanted_.size())) {
  if (schedule_.windows.size() == 1) return;
  series_box_ = box_of_series(pipeline, lattice_, source, wanted_);
  check_dense_size(*series_box_, pipeline);
}

void Writer::take(OutputFields output) {
  finish();
  // A task may be copied, fields may not.
  const auto fields = std::make_shared<OutputFields>(std::move(output));
  if (thread_count() == 1) return write(*fields);
  behind_.run([this, fields] { write(*fields); });
}

/// Steps stay steps.
void Writer::convert(OutputFields& output) const {
  if (has_time_) output.time.time = units_.converted(output.time.time, dimension::time);
  for (auto& [name, field] : output.fields)
    if (std::find(pipeline_.fields.begin(), pipeline_.fields.end(), name) != pipeline_.fields.end())
      units_.convert(field, written_lattice_);
}

void Writer::write(OutputFields& output) {
  const std::lock_guard lock(turn_);
  clock_.time("write", [&] {
    convert(output);
    std::vector<const SparseField*> fields;
    for (const std::string& name : pipeline_.fields)
      if (const auto it = output.fields.find(name); it != output.fields.end()) fields.push_back(&it->second);
    if (!begun_) {
      const Topology::Bounds box = series_box_ ? *series_box_ : box_of_voxels(pipeline_, *output.mask.topology());
      check_dense_size(box, pipeline_);
      for (const auto& sink : sinks_) sink->begin(layout(box, fields));
      begun_ = true;
    }
    for (const auto& sink : sinks_) sink->write(output.time, fields, writes_mask() ? &output.mask : nullptr);
  });
}

OutputLayout Writer::layout(const Topology::Bounds& bounds, const std::vector<const SparseField*>& fields) const {
  OutputLayout layout(written_lattice_);
  layout.first = bounds.first;
  layout.last = bounds.last;
  layout.time_count = schedule_.windows.size();
  for (const SparseField* f : fields) layout.fields.push_back(f->meta());
  layout.has_mask = writes_mask();
  layout.length_unit = units_.symbol(dimension::length);
  layout.time_unit = has_time_ ? units_.symbol(dimension::time) : "step";
  return layout;
}

/// Fields that can be undefined, or are made of such fields, are written with the reasons; so are output times that may
/// have no frame.
bool Writer::writes_mask() const {
  if (pipeline_.input.on_error == OnError::skip_frame && schedule_.windows.size() > 1) return true;
  if (pipeline_.walls.kernel != WallSpec::Kernel::cut) return true;
  return std::any_of(plan_.stages.begin(), plan_.stages.end(),
                     [](const Stage* s) { return !s->additive || !s->compute; });
}

void Writer::commit(RunReport& report) {
  finish();
  const std::lock_guard lock(turn_);
  std::vector<std::size_t> frames = frames_of(schedule_, wanted_);
  if (report.stop) frames.resize(report.stop->frames);
  clock_.time("write", [&] {
    for (const auto& sink : sinks_) {
      sink->commit(provenance_of(pipeline_, plan_, source_, frames, report));
      for (const std::string& file : sink->files()) report.files.push_back(file);
    }
  });
  const auto& seconds = clock_.seconds();
  report.seconds.insert(report.seconds.end(), seconds.begin(), seconds.end());
  report.wall_seconds = clock_.passed();
}

/// Whether the fields are computed where tracers do not come to, too.
bool streams_whole_fields(const RunSinks& to, const Pipeline& pipeline) {
  return !to.fields.empty() || measures_fields(pipeline) || (!computed_fields(pipeline).empty() && to.tracers.empty());
}

}  // namespace

RunReport run_into(const RunSinks& to, const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                   const std::function<void(const Progress&)>& progress, Checkpoint* checkpoint) {
  const auto& [sinks, tracer_sinks] = to;
  std::optional<MeasurePass> measurements;
  if (!pipeline.measure.empty()) measurements.emplace(pipeline, plan, source);
  std::optional<TracePass> tracers;
  if (pipeline.trace && !tracer_sinks.empty()) tracers.emplace(pipeline, plan, source, tracer_sinks);
  std::optional<Writer> writer;
  if (!sinks.empty()) writer.emplace(pipeline, plan, source, sinks);

  RunPasses passes{measurements ? &*measurements : nullptr, tracers ? &*tracers : nullptr};
  if (writer) passes.fields = [&](OutputFields output) { writer->take(std::move(output)); };
  passes.whole_fields = streams_whole_fields(to, pipeline);
  passes.checkpoint = checkpoint;
  RunReport report;
  try {
    report = make_passes(passes, pipeline, plan, source, progress);
  } catch (...) {
    if (writer) writer->finish();  // what failed in writing is earlier
    throw;
  }
  if (writer) writer->commit(report);
  if (tracers) tracers->commit(report);
  if (measurements) measurements->commit(report);
  if (checkpoint != nullptr) checkpoint->remove();
  return report;
}

RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::vector<std::unique_ptr<TracerSink>>& tracer_sinks,
                       const std::function<void(const Progress&)>& progress,
                       const std::optional<CheckpointOptions>& checkpoint) {
  std::optional<Checkpoint> kept;
  const bool whole_fields = streams_whole_fields({sinks, tracer_sinks}, pipeline);
  if (checkpoint && (whole_fields || measures_planes(pipeline))) {
    // By these checks all files of the input are known.
    whole_fields ? check_against_input(pipeline, plan, source) : check_measure_against_input(pipeline, source);
    kept.emplace(*checkpoint, key_of_run(pipeline, source));
  }
  return run_into({sinks, tracer_sinks}, pipeline, plan, source, progress, kept ? &*kept : nullptr);
}

RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::function<void(const Progress&)>& progress,
                       const std::optional<CheckpointOptions>& checkpoint) {
  return run_pipeline(pipeline, plan, source, sinks, {}, progress, checkpoint);
}

}  // namespace grainvdb
