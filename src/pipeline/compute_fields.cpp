#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tbb/task_arena.h>

#include "base/ordered_pipeline.hpp"
#include "base/parallel.hpp"
#include "grainvdb/run.hpp"
#include "pipeline/clip_fields.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/window.hpp"
#include "pipeline/written_box.hpp"

namespace grainvdb {
namespace {

using FramePtr = std::unique_ptr<FrameContext>;

std::size_t frames_in_flight(const Limits& limits) {
  if (limits.frames_in_flight > 0) return limits.frames_in_flight;
  constexpr std::size_t most = 8;
  const std::size_t threads = thread_count();
  return threads == 1 ? 1 : std::min(threads + 1, most);
}

std::size_t channel_count(const Plan& plan) {
  std::size_t n = 0;
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& pass : sweep.passes)
      for (const MomentPtr& m : pass) n += static_cast<std::size_t>(m->channels);
  return n;
}

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
         const std::optional<Region>& region)
      : pipeline_(pipeline),
        plan_(plan),
        source_(source),
        take_(take),
        progress_(progress),
        lattice_(lattice),
        region_(region),
        wanted_(select_frames(pipeline.frames, source.frames().size())),
        schedule_(schedule_windows(time_windows(pipeline), wanted_.size())),
        averager_(pipeline, plan, schedule_, lattice, region) {}

  RunReport run();

 private:
  Frame read(const Visit& visit);
  FramePtr prepare(const Visit& visit, Frame frame);
  void finish(const Visit& visit, FrameContext& frame);
  void show_progress(const Visit& visit);
  std::span<const std::size_t> frames_in(std::size_t window) const;
  DerivedFields derive() const;
  void end_window(std::size_t window);

  const Pipeline& pipeline_;
  const Plan& plan_;
  FrameSource& source_;
  const std::function<void(OutputFields)>& take_;
  const std::function<void(const Progress&)>& progress_;
  Lattice lattice_;
  std::optional<Region> region_;
  std::vector<std::size_t> wanted_;
  WindowSchedule schedule_;
  WindowAverager averager_;
  Stopwatch clock_;
  Progress now_;
  RunReport report_;
  std::size_t material_ = 0;  // particles that select kept, over frames and sweeps
};

RunReport Stream::run() {
  const std::vector<Visit> visits = schedule_visits(schedule_, wanted_, plan_.sweeps.size());
  now_.frames_total = visits.size();

  // What runs in parallel within a step is isolated: a thread that waits for the rest of it does not begin another
  // step.
  const std::size_t in_flight = std::min(frames_in_flight(pipeline_.limits), visits.size());
  ordered_pipeline(
      visits.size(), in_flight,
      [&](std::size_t i) { return tbb::this_task_arena::isolate([&] { return read(visits[i]); }); },
      [&](std::size_t i, Frame frame) {
        return tbb::this_task_arena::isolate([&] { return prepare(visits[i], std::move(frame)); });
      },
      [&](std::size_t i, FramePtr frame) {
        tbb::this_task_arena::isolate([&] { finish(visits[i], *frame); });
        frame.reset();
        show_progress(visits[i]);
        if (visits[i].ends_window) end_window(visits[i].window);
      });

  report_.frames = schedule_.frame_count();
  report_.channels = channel_count(plan_);
  report_.averaging.push_back(describe(schedule_, pipeline_));
  report_.seconds = clock_.seconds();
  report_.wall_seconds = clock_.passed();
  report_.read = source_.counters();
  return report_;
}

Frame Stream::read(const Visit& visit) {
  return clock_.time("read", [&] { return source_.read(visit.frame, plan_.sweeps[visit.sweep].columns); });
}

FramePtr Stream::prepare(const Visit& visit, Frame frame) {
  return clock_.time("prepare", [&] {
    return averager_.prepare(std::make_shared<const Material>(make_material(std::move(frame), pipeline_.select)),
                             visit.sweep);
  });
}

void Stream::finish(const Visit& visit, FrameContext& frame) {
  clock_.time("splat", [&] { averager_.add(frame, visit); });
  material_ += frame.particles().size();
  if (visit.ends_sweep) clock_.time("average", [&] { averager_.end_sweep(visit); });
}

void Stream::show_progress(const Visit& visit) {
  ++now_.frames_done;
  now_.doing = "frames";
  if (const std::size_t sweeps = plan_.sweeps.size(); sweeps > 1)
    now_.doing = "sweep " + std::to_string(visit.sweep + 1) + " of " + std::to_string(sweeps);
  if (progress_) progress_(now_);
}

std::span<const std::size_t> Stream::frames_in(std::size_t window) const {
  const FrameSpan& frames = schedule_.windows[window].frames;
  return std::span(wanted_).subspan(frames.first, frames.count);
}

DerivedFields Stream::derive() const {
  DerivedFields all = derive_fields(pipeline_, plan_, lattice_, source_.units(), averager_.means());
  if (region_) return clip_fields(all, *region_, lattice_);
  return all;
}

void Stream::end_window(std::size_t window) {
  // Contacts alone leave every other field undefined.
  const std::span<const std::size_t> frames = frames_in(window);
  if (window + 1 == schedule_.windows.size() && material_ == 0)
    throw InputError({{source_.frames()[frames.front()].file, 0},
                      "no material in any of the frames",
                      {},
                      "at least one particle that select keeps",
                      "Check select and frames"});
  DerivedFields derived =
      clock_.time("derive", [&] { return tbb::this_task_arena::isolate([&] { return derive(); }); });
  report_.summed_leaves = averager_.means().topology()->leaf_count();
  averager_.begin_window();
  report_.active_voxels = derived.mask.topology()->active_voxel_count();
  report_.grids += derived.grids;
  report_.masked.clear();
  for (const ReasonInfo& r : reasons())
    if (const std::size_t n = derived.mask.count(r.reason); n > 0) report_.masked.emplace_back(r.name, n);
  take_({time_of(source_, frames), std::move(derived.fields), std::move(derived.mask)});
}

}  // namespace

RunReport compute_fields(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                         const std::function<void(OutputFields)>& take,
                         const std::function<void(const Progress&)>& progress, const std::optional<Region>& region) {
  const Lattice lattice = check_against_input(pipeline, plan, source);
  return Stream(pipeline, plan, source, take, progress, lattice, region ? region : region_of(pipeline, lattice)).run();
}

}  // namespace grainvdb
