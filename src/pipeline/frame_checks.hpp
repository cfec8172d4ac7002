#pragma once
/// What is refused of a frame before anything is computed from it.
#include <cstddef>

#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "pipeline/material.hpp"

namespace grainvdb {

/// Refuses positions that lie too far from the box (LimitError).
void check_extents(const Material& material, const Lattice& lattice, const Pipeline& pipeline);
/// Refuses material so far apart that the box to be written would exceed the limit (LimitError).
void check_spread(const Material& material, const Lattice& lattice, const Pipeline& pipeline);

/// Memory that a splat takes.
struct SplatMemory {
  int buffered = 0;                ///< channels that the splat keeps of this frame
  std::size_t bytes_per_leaf = 0;  ///< of the sums
  std::size_t summed_leaves = 0;   ///< that the sums have already
};

/// Whether a splat onto so many leaves keeps within limits.memory_gb.
bool fits(double leaves, const SplatMemory& memory, const Pipeline& pipeline);
/// Refuses it where it does not (LimitError).
void check_memory(std::size_t leaves, const SplatMemory& memory, const Material& material, const Pipeline& pipeline);

}  // namespace grainvdb
