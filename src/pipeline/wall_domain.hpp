#pragma once
/// The walls of a pipeline file in the box of its input.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

/// None without surfaces and faces; else surfaces, then faces of the box. Throws ConfigError for a face that is
/// periodic or moves, and for a surface that a periodic boundary cuts: planes must be parallel to periodic axes,
/// cylinders parallel to them or a cutoff away from their boundaries, and cones have no place in a periodic box.
WallDomain wall_domain(const Pipeline& pipeline, const FrameSource& source, std::span<const std::size_t> wanted);

/// walls.clearance or, without it, 1.5 radii of the largest material grain of the first wanted frame that has any.
double wall_clearance(const Pipeline& pipeline, FrameSource& source, std::span<const std::size_t> wanted);

/// A wall in words.
std::string to_string(const Wall& wall);

}  // namespace grainvdb
