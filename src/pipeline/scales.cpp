#include "grainvdb/scales.hpp"

#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "grainvdb/memory_model.hpp"
#include "pipeline/run_into.hpp"
#include "pipeline/shared_frames.hpp"

namespace grainvdb {
namespace {

/// The input as one of the runs sees it.
class SharedSource final : public FrameSource {
 public:
  SharedSource(SharedFrames& frames, std::size_t user) : frames_(frames), user_(user) {}

  const std::vector<FrameInfo>& frames() const override { return frames_.source().frames(); }
  const UnitSystem& units() const override { return frames_.source().units(); }
  const std::vector<std::string>& particle_columns() const override { return frames_.source().particle_columns(); }
  std::vector<std::string> contact_columns() override {
    return frames_.with_source([](FrameSource& source) { return source.contact_columns(); });
  }
  std::vector<std::string> wall_contact_columns() override {
    return frames_.with_source([](FrameSource& source) { return source.wall_contact_columns(); });
  }
  std::vector<std::pair<std::string, std::uintmax_t>> files() const override {
    return frames_.with_source([](FrameSource& source) { return source.files(); });
  }
  void require(std::size_t k, ColumnSet wanted) override {
    frames_.with_source([&](FrameSource& source) { source.require(k, wanted); });
  }
  Frame read(std::size_t k, ColumnSet wanted) override { return frames_.read(user_, k, wanted); }
  std::vector<BadFrame> unreadable() const override {
    return frames_.with_source([](FrameSource& source) { return source.unreadable(); });
  }
  const ReadCounters& counters() const override { return none_; }

 private:
  SharedFrames& frames_;
  std::size_t user_;
  ReadCounters none_;
};

/// The progress of all runs together, and the first failure of any.
class Together {
 public:
  Together(std::size_t runs, const std::function<void(const Progress&)>& progress) : progress_(progress), done_(runs) {}

  void show(std::size_t run, const Progress& now) {
    const std::lock_guard lock(turn_);
    done_[run] = now.frames_done;
    if (!progress_) return;
    Progress all = now;
    all.frames_done = 0;
    for (const std::size_t done : done_) all.frames_done += done;
    all.frames_total = now.frames_total * done_.size();
    progress_(all);
  }
  void note(const std::exception_ptr& failure) {
    const std::lock_guard lock(turn_);
    if (!failure_) failure_ = failure;
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const std::function<void(const Progress&)>& progress_;
  std::mutex turn_;
  std::vector<std::size_t> done_;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<Pipeline> at_scales(const Pipeline& pipeline) {
  if (pipeline.scales.empty()) return {pipeline};
  std::vector<Pipeline> all;
  for (const Scale& scale : pipeline.scales) {
    Pipeline& p = all.emplace_back(pipeline);
    p.scales.clear();
    p.cutoff = scale.cutoff;
    p.voxel = scale.voxel;
    p.resolved = scale.resolved;
    // How often passes around the tracers alone read the frames, depends on the scale.
    if (p.trace) p.trace->neighbourhood = TraceSpec::Neighbourhood::never;
  }
  return all;
}

std::vector<RunReport> run_scales(std::vector<ScaleRun>& runs, FrameSource& source,
                                  const std::function<void(const Progress&)>& progress) {
  SharedFrames frames(source, runs.size(), frames_in_flight(runs.at(0).pipeline.limits));
  Together together(runs.size(), progress);
  std::vector<RunReport> reports(runs.size());
  const auto run = [&](std::size_t n) {
    try {
      SharedSource own(frames, n);
      const ScaleRun& at = runs[n];
      reports[n] = run_into(
          {at.sinks, at.tracer_sinks}, at.pipeline, at.plan, own,
          [&, n](const Progress& now) { together.show(n, now); }, nullptr);
    } catch (const SharedFrames::Abandoned&) {
      return;  // because of what failed elsewhere
    } catch (...) {
      together.note(std::current_exception());
      frames.abandon();
    }
    frames.leave(n);
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t n = 0; n < runs.size(); ++n) threads.emplace_back(run, n);
  }
  together.rethrow();
  const MemoryModel model = memory_model(runs[0].plan, runs[0].pipeline);
  const auto [particles, contacts] = frames.largest();
  double memory = model.more_than_sum(runs.size(), particles, contacts);
  for (const RunReport& report : reports) memory += report.memory;
  for (RunReport& report : reports) {
    report.read = source.counters();
    report.memory = memory;
  }
  return reports;
}

}  // namespace grainvdb
