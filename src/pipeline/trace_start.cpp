#include "pipeline/trace_start.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "grainvdb/run.hpp"
#include "pipeline/material.hpp"
#include "pipeline/schedule.hpp"

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

TracerSeeds on_particles(const Pipeline& pipeline, FrameSource& source, std::size_t k) {
  ColumnSet columns;
  if (!pipeline.select.types.empty()) columns |= Column::type;
  Frame frame = source.read(k, columns);
  apply_selection(pipeline.select, frame.box, frame.particles);
  const SeedSpec::OnParticles& spec = *pipeline.trace->seeds.particles;
  std::vector<std::int64_t> ids = spec.ids;
  if (ids.empty())
    for (std::size_t i = 0; i < frame.particles.size(); i += spec.every) ids.push_back(frame.particles.id[i]);
  try {
    return seeds_on_particles(frame.particles, ids);
  } catch (const std::invalid_argument& e) {
    throw ConfigError({pipeline.location("trace.seeds.particles"),
                       e.what(),
                       {},
                       "particles that are material at step " + std::to_string(frame.step) + " of " + frame.file,
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

TracerSeeds make_seeds(const Pipeline& pipeline, FrameSource& source, const Box& box, std::size_t k) {
  const SeedSpec& spec = pipeline.trace->seeds;
  if (spec.particles) return on_particles(pipeline, source, k);
  try {
    return spec.grid ? seeds_on_grid(grid_within(*spec.grid, box)) : seeds_at(spec.points);
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
