#pragma once
/// Where the tracers of a pipeline start, and between which walls.
#include <cstddef>
#include <span>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/seeds.hpp"

namespace grainvdb {

/// The box of the tracers: the periods of the first frame; along open axes, what the boxes of all frames cover.
Box trace_box(const FrameSource& source, std::span<const std::size_t> frames);

/// The seeds; those on particles are on the material of frame `k`, which is read for them alone. Throws ConfigError,
/// InputError, IoError or LimitError.
TracerSeeds make_seeds(const Pipeline& pipeline, FrameSource& source, const Box& box, std::size_t k);

/// The time of a frame, or its step where the dump has no time.
double time_of(const FrameInfo& frame);

}  // namespace grainvdb
