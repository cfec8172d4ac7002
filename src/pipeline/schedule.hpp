#pragma once
/// In which order frames are visited: window by window, each swept as often as the plan asks.
#include <cstddef>
#include <span>
#include <vector>

#include "grainvdb/pipeline.hpp"

namespace grainvdb {

/// One visit of a frame.
struct Visit {
  std::size_t frame = 0;  ///< index into the source
  std::size_t sweep = 0;
  bool ends_sweep = false;   ///< the last of its sweep over the window
  bool ends_window = false;  ///< the last of its window
};

/// How many output times a number of frames makes.
std::size_t window_count(const Pipeline& pipeline, std::size_t frames);

/// `wanted` in windows of the pipeline's length, the last of which may be shorter.
std::vector<Visit> schedule_visits(const Pipeline& pipeline, std::span<const std::size_t> wanted, std::size_t sweeps);

}  // namespace grainvdb
