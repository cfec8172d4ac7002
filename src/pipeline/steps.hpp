#pragma once
/// Frames by their steps: those of a run that goes on must be those that it began with.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/frame_source.hpp"

namespace grainvdb {

/// The steps of frames, given by their index into the source.
std::vector<std::int64_t> steps_of(const FrameSource& source, std::span<const std::size_t> frames);

/// Refuses frames that do not begin with these steps (InputError).
void require_first_steps(const FrameSource& source, std::span<const std::size_t> frames,
                         const std::vector<std::int64_t>& steps);

}  // namespace grainvdb
