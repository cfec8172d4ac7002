#pragma once
/// The moments of one output time: the frames of a window, swept as often as the plan asks.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "average/moment_sums.hpp"
#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "pipeline/stopwatch.hpp"

namespace grainvdb {

struct WindowMoments {
  MomentSums sums;
  MomentMeans means;  ///< a view of the sums
  OutputTime time;
  std::size_t material = 0;  ///< particles that select kept, summed over frames and sweeps
};

/// Reads and splats the frames `wanted` (indices into the source). `frame_done(sweep)` is called after each frame of
/// each sweep. Throws LimitError when the sums would outgrow limits.memory_gb.
WindowMoments average_window(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source,
                             std::span<const std::size_t> wanted, Stopwatch& clock,
                             const std::function<void(std::size_t sweep)>& frame_done);

}  // namespace grainvdb
