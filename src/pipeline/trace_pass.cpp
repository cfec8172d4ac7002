#include "pipeline/trace_pass.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "grainvdb/memory_model.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/trace_start.hpp"
#include "pipeline/unless_bad.hpp"

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

/// Where the particles are in the first frame that can be read, selected or not; nothing when there is none.
std::optional<Particles> first_particles(const Pipeline& pipeline, FrameSource& source,
                                         const std::vector<std::size_t>& wanted) {
  for (const std::size_t k : wanted)
    if (auto frame = read_unless_bad(pipeline.input, source, k, {})) return std::move(frame->particles);
  return std::nullopt;
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
  all.memory = std::max(all.memory, more.memory);
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
      lattice_(checked_lattice(pipeline, plan, source)),
      wanted_(select_frames(pipeline.frames, source.frames().size())),
      seeds_(make_seeds(pipeline, plan, source, wanted_)),
      run_(pipeline, source, lattice_, wanted_, seeds_, sinks) {}

RunReport TracePass::compute(const Show& progress) {
  if (backward_) return compute_backward(progress);
  if (auto report = compute_nearby(progress)) return *report;
  return compute_fields(
      pipeline_, plan_, source_, [&](const OutputFields& output) { take(output); }, progress);
}

/// Passes that write nothing find out where the tracers go; nothing when whole grids are the better choice. Through the
/// mean, the fields of the pass in which they stayed in their neighbourhood serve for the histories; through frames
/// there is one more pass.
std::optional<RunReport> TracePass::compute_nearby(const Show& progress) {
  using Neighbourhood = TraceSpec::Neighbourhood;
  const TraceSpec& spec = *pipeline_.trace;
  if (pipeline_.region || spec.neighbourhood == Neighbourhood::never) return std::nullopt;
  const bool always = spec.neighbourhood == Neighbourhood::always;
  const bool mean = spec.through == TraceSpec::Through::mean;
  // Ways double from pass to pass: after 20 they lead out of any lattice.
  const std::size_t most = always ? 20 : 4;
  const double reach = pipeline_.cutoff / pipeline_.voxel;
  const int expected = mean ? 2 : 3;
  constexpr std::size_t most_tracers = 100'000;  // each is looked after in every move
  if (!always && (run_.report().tracers > most_tracers || !neighbourhood_pays(0, reach, expected))) return std::nullopt;
  const auto particles = first_particles(pipeline_, source_, wanted_);
  if (!particles) return std::nullopt;

  TraceNeighbourhood neighbourhood(lattice_);
  const TraceRun::Sinks nothing;
  for (std::size_t pass = 1; pass <= most; ++pass) {
    TraceRun search(pipeline_, source_, lattice_, wanted_, seeds_, nothing);
    search.stay_in(neighbourhood);
    const Region region = neighbourhood.region();
    if (region.empty()) return std::nullopt;  // every seed lies outside the box
    const double share = share_of_particles(*particles, region, plan_, lattice_, pipeline_.cutoff);
    if (!always && !neighbourhood_pays(share, reach, expected)) return std::nullopt;
    std::optional<OutputFields> fields;
    const auto look = [&](OutputFields output) {
      clock_.time("trace", [&] { search.take(output); });
      if (mean) fields.emplace(std::move(output));
    };
    try {
      RunReport report = compute_fields(pipeline_, plan_, source_, look, progress, region);
      if (mean) {
        take(*fields);
      } else {
        report = compute_fields(
            pipeline_, plan_, source_, [&](const OutputFields& output) { take(output); }, progress, region);
      }
      run_.found_nearby(mean ? pass : pass + 1, share);
      return report;
    } catch (const LeftNeighbourhood& left) {
      if (!left.grew) return std::nullopt;
    }
  }
  return std::nullopt;
}

RunReport TracePass::compute_backward(const Show& progress) {
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
  report.memory += memory_model(plan_, pipeline_).per_tracer * static_cast<double>(report.trace->tracers);
}

}  // namespace grainvdb
