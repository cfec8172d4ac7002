#include "pipeline/trace_start.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/run.hpp"
#include "pipeline/material.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/unless_bad.hpp"

namespace grainvdb {
namespace {

SeedGrid grid_within(const SeedSpec::Grid& spec, const Box& box) {
  SeedGrid grid;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.lo[a] = std::isinf(spec.lo[a]) ? box.lo[a] : spec.lo[a];
    grid.hi[a] = std::isinf(spec.hi[a]) ? box.hi[a] : spec.hi[a];
  }
  grid.spacing = spec.spacing;
  return grid;
}

/// The frames with which tracers may start, the first choice first: output time after output time, and in each those
/// nearest to its middle.
std::vector<std::size_t> first_frames(const Pipeline& pipeline, std::span<const std::size_t> wanted) {
  const TraceSpec& spec = *pipeline.trace;
  if (spec.through == TraceSpec::Through::mean) return {wanted.begin(), wanted.end()};
  auto windows = windows_of(pipeline, wanted);
  if (spec.direction == TraceSpec::Direction::backward) std::reverse(windows.begin(), windows.end());
  std::vector<std::size_t> all;
  for (std::vector<std::size_t>& frames : windows) {
    const std::size_t middle = frames[(frames.size() - 1) / 2];
    const auto from_middle = [&](std::size_t k) { return k < middle ? middle - k : k - middle; };
    std::stable_sort(frames.begin(), frames.end(),
                     [&](std::size_t a, std::size_t b) { return from_middle(a) < from_middle(b); });
    all.insert(all.end(), frames.begin(), frames.end());
  }
  return all;
}

/// The material of the first frame that is not left out. Whether it will be shows in all that the run needs of it.
Material first_material(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                        const std::vector<std::size_t>& frames) {
  ColumnSet columns;
  std::set<BranchKind> branches;
  if (pipeline.input.on_error == OnError::skip_frame) {
    columns = all_columns(plan);
    branches = all_branch_kinds(plan);
  }
  if (!pipeline.select.types.empty()) columns |= Column::type;
  columns |= columns_of(pipeline.species);
  for (const std::size_t k : frames)
    if (auto material =
            unless_bad(pipeline.input, [&] { return make_material(source.read(k, columns), pipeline, branches); }))
      return std::move(*material);
  throw InputError({{source.frames()[frames.back()].file, 0},
                    "every frame is bad, and input.on_error leaves them all out",
                    std::to_string(frames.size()),
                    "at least one frame that can be used",
                    {}});
}

TracerSeeds on_particles(const Pipeline& pipeline, const Material& material) {
  const Particles& particles = material.particles;
  const SeedSpec::OnParticles& spec = *pipeline.trace->seeds.particles;
  std::vector<std::int64_t> ids = spec.ids;
  if (ids.empty())
    for (std::size_t i = 0; i < particles.size(); i += spec.every) ids.push_back(particles.id[i]);
  try {
    return seeds_on_particles(particles, ids);
  } catch (const std::invalid_argument& e) {
    throw ConfigError({pipeline.location("trace.seeds.particles"),
                       e.what(),
                       {},
                       "particles that are material at step " + std::to_string(material.step) + " of " + material.file,
                       {}});
  }
}

}  // namespace

Box trace_box(const FrameSource& source, std::span<const std::size_t> frames) {
  Box box = source.frames()[frames.front()].box;
  for (const std::size_t k : frames)
    for (std::size_t a = 0; a < 3; ++a) {
      if (box.periodic[a]) continue;
      box.lo[a] = std::min(box.lo[a], source.frames()[k].box.lo[a]);
      box.hi[a] = std::max(box.hi[a], source.frames()[k].box.hi[a]);
    }
  return box;
}

TracerSeeds make_seeds(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       std::span<const std::size_t> wanted) {
  const SeedSpec& spec = pipeline.trace->seeds;
  if (spec.particles)
    return on_particles(pipeline, first_material(pipeline, plan, source, first_frames(pipeline, wanted)));
  try {
    return spec.grid ? seeds_on_grid(grid_within(*spec.grid, trace_box(source, wanted))) : seeds_at(spec.points);
  } catch (const std::invalid_argument& e) {
    throw ConfigError({pipeline.location("trace.seeds"), e.what(), {}, {}, {}});
  }
}

void check_trace_against_input(const Pipeline& pipeline, const FrameSource& source) {
  if (!pipeline.trace) return;
  const std::vector<std::size_t> frames = select_frames(pipeline.frames, source.frames().size());
  const TraceSpec& trace = *pipeline.trace;
  const auto refuse = [&](const char* key, const std::string& what, const char* expected, const char* hint) {
    throw ConfigError({pipeline.location(key), what, {}, expected, hint});
  };
  const bool mean = trace.through == TraceSpec::Through::mean;
  if (mean && trace.duration) return;
  if (!source.frames()[frames.front()].time)
    refuse(mean ? "trace" : "trace.through", "the dump has no time, which the tracers need",
           mean ? "trace.duration or input.dt" : "input.dt, the time per step", "");
  if (mean && frames.size() < 2) refuse("trace", "one frame has no duration", "trace.duration, a time", "");
  if (!mean && windows_of(pipeline, frames).size() < 2)
    refuse("trace.through", "tracers move from one output time to the next, and there is one",
           "average.window: 1, and at least two frames", "");
}

double time_of(const FrameInfo& frame) {
  return frame.time.value_or(static_cast<double>(frame.step));
}

}  // namespace grainvdb
