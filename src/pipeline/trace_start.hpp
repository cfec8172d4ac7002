#pragma once
/// Where the tracers of a pipeline start, and between which walls.
#include <cstddef>
#include <span>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/seeds.hpp"

namespace grainvdb {

/// The box of the tracers: the periods of the first frame; along open axes, what the boxes of all frames cover.
Box trace_box(const FrameSource& source, std::span<const std::size_t> frames);

/// The seeds, where `wanted` are the frames of the pipeline, in ascending order. Those on particles are on the material
/// of the frame at the output time at which tracers start, which is read for them alone. Where bad frames are left out
/// it is the first that the run will not leave out. Throws ConfigError, InputError, IoError or LimitError.
TracerSeeds make_seeds(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       std::span<const std::size_t> wanted);

/// The time of a frame, or its step where the dump has no time.
double time_of(const FrameInfo& frame);

}  // namespace grainvdb
