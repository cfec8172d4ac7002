#include "pipeline/trace_pass.hpp"

#include <algorithm>
#include <string>

#include "pipeline/provenance.hpp"
#include "pipeline/schedule.hpp"

namespace grainvdb {
namespace {

Lattice checked_lattice(const Pipeline& pipeline, const Plan& plan, FrameSource& source) {
  Lattice lattice = check_against_input(pipeline, plan, source);
  check_trace_against_input(pipeline, source);
  return lattice;
}

/// The pipeline for the frames of one output time alone.
Pipeline only(const Pipeline& pipeline, const std::vector<std::size_t>& frames) {
  Pipeline one = pipeline;
  one.window = 0;
  one.frames = {static_cast<std::int64_t>(frames.front()), static_cast<std::int64_t>(frames.back()) + 1,
                frames.size() > 1 ? static_cast<std::int64_t>(frames[1] - frames[0]) : 1};
  return one;
}

/// Adds what a pass over more frames did.
void add(RunReport& all, const RunReport& more) {
  all.frames += more.frames;
  all.active_voxels = more.active_voxels;
  all.channels = more.channels;
  all.grids += more.grids;
  all.wall_seconds += more.wall_seconds;
  for (const auto& [step, seconds] : more.seconds) {
    auto it = std::find_if(all.seconds.begin(), all.seconds.end(), [&](const auto& s) { return s.first == step; });
    if (it == all.seconds.end()) it = all.seconds.insert(it, {step, 0});
    it->second += seconds;
  }
  all.masked = more.masked;
  all.read = more.read;
}

}  // namespace

TracePass::TracePass(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const TraceRun::Sinks& sinks)
    : pipeline_(pipeline),
      plan_(plan),
      source_(source),
      backward_(pipeline.trace->through == TraceSpec::Through::frames &&
                pipeline.trace->direction == TraceSpec::Direction::backward),
      wanted_(select_frames(pipeline.frames, source.frames().size())),
      run_(pipeline, source, checked_lattice(pipeline, plan, source), wanted_, sinks) {}

RunReport TracePass::compute(const std::function<void(const Progress&)>& progress) {
  if (goes_along())
    return compute_fields(
        pipeline_, plan_, source_, [&](const OutputFields& output) { take(output); }, progress);
  RunReport report;
  const auto windows = windows_of(pipeline_, wanted_);
  std::size_t done = 0;
  for (auto window = windows.rbegin(); window != windows.rend(); ++window) {
    const Pipeline one = only(pipeline_, *window);
    add(report, compute_fields(
                    one, plan_, source_, [&](const OutputFields& output) { take(output); },
                    [&](const Progress& p) {
                      if (progress) progress({++done, wanted_.size() * plan_.sweeps.size(), p.doing});
                    }));
  }
  return report;
}

void TracePass::commit(RunReport& report) {
  clock_.time("trace", [&] { run_.commit(provenance_of(pipeline_, plan_, source_, wanted_, report)); });
  report.seconds.insert(report.seconds.end(), clock_.seconds().begin(), clock_.seconds().end());
  report.trace = run_.report();
}

}  // namespace grainvdb
