#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tbb/task_arena.h>

#include "base/ordered_pipeline.hpp"
#include "grainvdb/memory_model.hpp"
#include "grainvdb/run.hpp"
#include "pipeline/bad_frames.hpp"
#include "pipeline/clip_fields.hpp"
#include "pipeline/derive_errors.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/no_material.hpp"
#include "pipeline/run_tally.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/steps.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/stream.hpp"
#include "pipeline/until.hpp"
#include "pipeline/wall_treatment.hpp"
#include "pipeline/window.hpp"
#include "pipeline/written_box.hpp"

namespace grainvdb {
namespace {

using FramePtr = std::unique_ptr<FrameContext>;
using MaybeFrame = OrFault<Frame>;
using MaybeReady = OrFault<FramePtr>;

OutputTime time_of(const FrameSource& source, std::span<const std::size_t> frames) {
  OutputTime t;
  t.first_step = source.frames()[frames.front()].step;
  t.last_step = source.frames()[frames.back()].step;
  t.frame_count = frames.size();
  for (std::size_t k : frames) {
    const FrameInfo& frame = source.frames()[k];
    t.time += frame.time.value_or(static_cast<double>(frame.step)) / static_cast<double>(frames.size());
  }
  return t;
}

/// The streaming executor: what the steps of the pipeline work on.
class Stream {
 public:
  Stream(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const std::function<void(OutputFields)>& take,
         const std::function<void(const Progress&)>& progress, const Lattice& lattice,
         const std::optional<Region>& region, Checkpoint* checkpoint)
      : pipeline_(pipeline),
        plan_(plan),
        source_(source),
        take_(take),
        progress_(progress),
        lattice_(lattice),
        region_(region),
        checkpoint_(checkpoint),
        wanted_(select_frames(pipeline.frames, source.frames().size())),
        frames_there_(wanted_.size()),
        end_(wanted_.size()),
        schedule_(schedule_windows(time_windows(pipeline, plan), wanted_.size())),
        averager_(pipeline, plan, schedule_, lattice, region),
        walls_(WallTreatment::make(pipeline, plan, lattice, source, wanted_)),
        tally_(images_per_particle(lattice, pipeline)) {}

  RunReport run();
  /// Only the visits that further frames would not change.
  std::size_t run_certain();

 private:
  void go_through(std::span<const Visit> visits);
  MaybeFrame read(const Visit& visit);
  MaybeReady prepare(const Visit& visit, MaybeFrame frame);
  void finish(const Visit& visit, MaybeReady& frame);
  bool is_usable(const Visit& visit, const MaybeReady& frame);
  bool is_past_end(const Visit& visit) const { return visit.place >= end_; }
  bool ends_sweep(const Visit& visit) const { return visit.ends_sweep || visit.place + 1 == end_; }
  bool ends_window(const Visit& visit) const { return ends_sweep(visit) && visit.sweep + 1 == plan_.sweeps.size(); }
  void end_where_certain(std::size_t frames);
  void end_at(std::size_t frames);
  DeriveSetting derive_setting(const ErrorPlan& errors);
  void note_stop(const DerivedFields& all);
  void note_step(std::size_t frame);
  void show_progress(const Visit& visit);
  OutputTime time_of_window(std::size_t window) const;
  void require_material() const;
  DerivedFields derive();
  void end_window(std::size_t window);

  void resume();
  void save_progress();
  void save(ByteWriter& to) const;
  void load(ByteReader& from);

  const Pipeline& pipeline_;
  const Plan& plan_;
  FrameSource& source_;
  const std::function<void(OutputFields)>& take_;
  const std::function<void(const Progress&)>& progress_;
  Lattice lattice_;
  std::optional<Region> region_;
  Checkpoint* checkpoint_;
  std::vector<std::size_t> wanted_;
  const std::size_t frames_there_;
  std::atomic<std::size_t> end_;  // frames in the window, where averaging stops by itself
  WindowSchedule schedule_;
  WindowAverager averager_;
  std::optional<WallTreatment> walls_;
  Stopwatch clock_;
  Progress now_;
  RunTally tally_;
  std::size_t outputs_ = 0;  // output times that are finished
  std::optional<std::size_t> last_window_;
  std::size_t steps_done_ = 0;  // frames, from the first on, that were visited
  BadFrames bad_;
};

RunReport Stream::run() {
  if (checkpoint_ != nullptr) resume();
  const std::vector<Visit> visits = schedule_visits(schedule_, wanted_, plan_.sweeps.size());
  now_.frames_total = visits.size();
  last_window_ = schedule_.windows.size() - 1;
  for (std::size_t k = 0; k < outputs_; ++k) take_(checkpoint_->load_output(k, lattice_));
  go_through(std::span(visits).subspan(now_.frames_done));
  if (checkpoint_ != nullptr) save_progress();  // passes may follow

  RunReport report = tally_.report(plan_, pipeline_);
  report.frames = schedule_.frame_count() - bad_.count();
  if (checkpoint_ != nullptr) report.resumed_at = checkpoint_->resumed_at();
  report.bad_frames = bad_.list(source_);
  report.averaging.push_back(describe(schedule_, pipeline_));
  if (report.stop) {
    report.averaging.push_back(describe(*pipeline_.until, *report.stop));
  } else if (!plan_.errors.errors.empty()) {
    report.averaging.push_back(describe_blocks(schedule_));
  }
  if (walls_) report.walls = walls_->describe();
  report.seconds = clock_.seconds();
  report.wall_seconds = clock_.passed();
  report.read = source_.counters();
  return report;
}

std::size_t Stream::run_certain() {
  if (pipeline_.until) return 0;  // where averaging ends is told from all the frames that there are
  const std::vector<Visit> visits = schedule_visits(schedule_, wanted_, plan_.sweeps.size());
  now_.frames_total = certain_visits(time_windows(pipeline_, plan_), wanted_.size(), plan_.sweeps.size());
  resume();
  if (now_.frames_done < now_.frames_total) {
    go_through(std::span(visits).first(now_.frames_total).subspan(now_.frames_done));
    save_progress();
  }
  return now_.frames_done;
}

void Stream::go_through(std::span<const Visit> visits) {
  if (visits.empty()) return;
  // What runs in parallel within a step is isolated: a thread that waits for the rest of it does not begin another
  // step.
  const std::size_t in_flight = std::min(frames_in_flight(pipeline_.limits), visits.size());
  ordered_pipeline(
      visits.size(), in_flight,
      [&](std::size_t i) { return tbb::this_task_arena::isolate([&] { return read(visits[i]); }); },
      [&](std::size_t i, MaybeFrame frame) {
        return tbb::this_task_arena::isolate([&] { return prepare(visits[i], std::move(frame)); });
      },
      [&](std::size_t i, MaybeReady frame) {
        if (is_past_end(visits[i])) return;
        tbb::this_task_arena::isolate([&] { finish(visits[i], frame); });
        frame = {};
        if (ends_window(visits[i])) end_window(visits[i].window);
        note_step(visits[i].frame);
        show_progress(visits[i]);
        if (checkpoint_ != nullptr && checkpoint_->is_due()) save_progress();
      });
}

MaybeFrame Stream::read(const Visit& visit) {
  if (is_past_end(visit)) return {};
  // Whether a frame is bad must be known before it is in any sum.
  const bool all = pipeline_.input.on_error == OnError::skip_frame && visit.sweep == 0;
  const ColumnSet columns = all ? all_columns(plan_) : plan_.sweeps[visit.sweep].columns;
  return clock_.time("read", [&] { return attempt([&] { return source_.read(visit.frame, columns); }); });
}

MaybeReady Stream::prepare(const Visit& visit, MaybeFrame frame) {
  if (!frame.value) return {{}, frame.fault};
  return clock_.time("prepare", [&] {
    return attempt([&] {
      const std::set<BranchKind>& branches = plan_.sweeps[visit.sweep].branch_kinds;
      Material material = make_material(std::move(*frame.value), pipeline_, branches);
      if (walls_) walls_->apply(material);
      return averager_.prepare(std::make_shared<const Material>(std::move(material)), visit.sweep);
    });
  });
}

void Stream::finish(const Visit& visit, MaybeReady& frame) {
  if (is_usable(visit, frame)) {
    clock_.time("splat", [&] { averager_.add(**frame.value, visit); });
    tally_.add(**frame.value);
  } else {
    averager_.leave_out(visit);
  }
  if (pipeline_.until && visit.sweep == 0) end_where_certain(visit.place + 1);
  if (ends_sweep(visit)) clock_.time("average", [&] { averager_.end_sweep(visit); });
}

/// A frame that was good in the first sweep has changed when it is bad in another.
bool Stream::is_usable(const Visit& visit, const MaybeReady& frame) {
  if (bad_.contains(visit.frame)) return false;
  if (!frame.fault) return true;
  if (visit.sweep > 0 || pipeline_.input.on_error == OnError::error) std::rethrow_exception(frame.fault);
  bad_.add(visit.frame, frame.fault);
  return false;
}

void Stream::end_where_certain(std::size_t frames) {
  if (!is_time_to_look(pipeline_, frames)) return;
  const double error = clock_.time("errors", [&] {
    return tbb::this_task_arena::isolate(
        [&] { return error_so_far(derive_setting(plan_.until), averager_.sums(), region_); });
  });
  now_.error = describe_progress(*pipeline_.until, error);
  if (error <= pipeline_.until->error) end_at(frames);
}

/// Frames behind are in no sum of any sweep; there is one window.
void Stream::end_at(std::size_t frames) {
  end_ = frames;
  wanted_.resize(frames);
  schedule_.windows.front().frames.count = frames;
  schedule_.parts.front().count = frames;
  now_.frames_total = plan_.sweeps.size() * frames;
}

DeriveSetting Stream::derive_setting(const ErrorPlan& errors) {
  return {pipeline_, errors, lattice_, source_.units(), walls_ ? &*walls_ : nullptr};
}

void Stream::note_step(std::size_t frame) {
  const auto place = std::lower_bound(wanted_.begin(), wanted_.end(), frame) - wanted_.begin();
  steps_done_ = std::max(steps_done_, static_cast<std::size_t>(place) + 1);
}

void Stream::show_progress(const Visit& visit) {
  ++now_.frames_done;
  now_.doing = "frames";
  if (const std::size_t sweeps = plan_.sweeps.size(); sweeps > 1)
    now_.doing = "sweep " + std::to_string(visit.sweep + 1) + " of " + std::to_string(sweeps);
  if (!progress_) return;
  try {
    progress_(now_);
  } catch (...) {
    if (checkpoint_ != nullptr) save_progress();
    throw;
  }
}

OutputTime Stream::time_of_window(std::size_t window) const {
  const FrameSpan& span = schedule_.windows[window].frames;
  const auto all = std::span(wanted_).subspan(span.first, span.count);
  std::vector<std::size_t> good;
  std::copy_if(all.begin(), all.end(), std::back_inserter(good), [&](std::size_t k) { return !bad_.contains(k); });
  OutputTime time = time_of(source_, good.empty() ? all : good);
  time.frame_count = good.size();
  return time;
}

/// Contacts alone leave every other field undefined.
void Stream::require_material() const {
  const std::vector<BadFrame> bad = bad_.list(source_);
  if (bad_.count() == schedule_.frame_count())
    throw InputError({{bad.back().file, 0},
                      "every frame is bad, and input.on_error leaves them all out",
                      std::to_string(bad.size()) + ", of which the last: " + bad.back().reason,
                      "at least one frame that can be used",
                      {}});
  if (!tally_.has_material()) refuse_no_material(pipeline_, source_, wanted_);
}

DerivedFields Stream::derive() {
  const std::vector<std::string> computed = computed_fields(pipeline_);
  const std::set<std::string> wanted(computed.begin(), computed.end());
  std::set<std::string> kept = wanted;
  for (const Stage* stage : plan_.stages)
    if (!stage->error_of.empty()) kept.insert(stage->error_of);
  std::optional<WallTreatment::Renormalised> inside;
  if (walls_) inside.emplace(walls_->renormalise(averager_.means(), plan_.means));
  DerivedFields all = derive_fields(pipeline_, plan_.stages, kept, lattice_, source_.units(),
                                    inside ? inside->means : averager_.means());
  derive_errors(derive_setting(plan_.errors), averager_.sums(), averager_.means(), all);
  if (walls_) walls_->mask(all);
  if (pipeline_.until) note_stop(all);
  std::erase_if(all.fields, [&](const auto& entry) { return !wanted.contains(entry.first); });
  if (region_) return clip_fields(all, *region_, lattice_);
  return all;
}

void Stream::note_stop(const DerivedFields& all) {
  const Until& until = *pipeline_.until;
  const double error =
      error_of_share(until, all.fields.at(until.field), all.fields.at(until.field + "_error"), region_);
  tally_.note_stop({wanted_.size(), frames_there_, end_ < frames_there_ || error <= until.error, error});
}

void Stream::end_window(std::size_t window) {
  if (window == last_window_) require_material();
  DerivedFields derived =
      clock_.time("derive", [&] { return tbb::this_task_arena::isolate([&] { return derive(); }); });
  tally_.add(derived, averager_.means().topology()->leaf_count());
  averager_.begin_window();
  OutputFields output{time_of_window(window), std::move(derived.fields), std::move(derived.mask)};
  if (checkpoint_ != nullptr) clock_.time("checkpoint", [&] { checkpoint_->save_output(window, output); });
  outputs_ = window + 1;
  take_(std::move(output));
}

void Stream::resume() {
  if (!checkpoint_->has_state()) return;
  checkpoint_->load_state([&](ByteReader& from) { load(from); });
  checkpoint_->note_resumed(now_.frames_done);
}

void Stream::save_progress() {
  clock_.time("checkpoint", [&] { checkpoint_->save_state([&](ByteWriter& to) { save(to); }); });
}

void Stream::save(ByteWriter& to) const {
  to.number(std::uint64_t{frames_there_});
  to.number(std::uint64_t{now_.frames_done});
  to.number(std::uint64_t{outputs_});
  // Where further frames may come, an end that is only that of the input is none.
  to.number(end_ < frames_there_ ? std::uint64_t{end_} : std::numeric_limits<std::uint64_t>::max());
  to.numbers(steps_of(source_, std::span(wanted_).first(steps_done_)));
  averager_.save(to);
  bad_.save(to);
  tally_.save(to);
}

/// Of another number of frames only what is certain counts; where more was done, the run begins anew.
void Stream::load(ByteReader& from) {
  const std::size_t frames = from.count(), done = from.count();
  if (frames != frames_there_ && done > certain_visits(time_windows(pipeline_, plan_), frames, plan_.sweeps.size()))
    return;
  now_.frames_done = done;
  outputs_ = from.count();
  if (const std::size_t end = from.count(); end < frames_there_) end_at(end);
  const std::vector<std::int64_t> steps = from.numbers<std::int64_t>();
  require_first_steps(source_, wanted_, steps);
  steps_done_ = steps.size();
  averager_.load(from);
  bad_.load(from);
  tally_.load(from);
}

}  // namespace

RunReport stream_fields(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                        const std::function<void(OutputFields)>& take,
                        const std::function<void(const Progress&)>& progress, const std::optional<Region>& region,
                        Checkpoint* checkpoint) {
  const Lattice lattice = check_against_input(pipeline, plan, source);
  return Stream(pipeline, plan, source, take, progress, lattice, region ? region : region_of(pipeline, lattice),
                checkpoint)
      .run();
}

std::size_t stream_certain(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                           const std::function<void(const Progress&)>& progress, Checkpoint& checkpoint) {
  const Lattice lattice = check_against_input(pipeline, plan, source);
  const std::function<void(OutputFields)> leave_in_checkpoint = [](const OutputFields&) {};
  return Stream(pipeline, plan, source, leave_in_checkpoint, progress, lattice, region_of(pipeline, lattice),
                &checkpoint)
      .run_certain();
}

RunReport compute_fields(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                         const std::function<void(OutputFields)>& take,
                         const std::function<void(const Progress&)>& progress, const std::optional<Region>& region) {
  return stream_fields(pipeline, plan, source, take, progress, region, nullptr);
}

}  // namespace grainvdb
