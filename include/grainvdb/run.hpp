#pragma once
/// Runs a pipeline: streams the frames through the plan's sweeps, averages, derives and writes.
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

struct Progress {
  std::size_t frames_done = 0;  ///< over all sweeps
  std::size_t frames_total = 0;
  std::string doing;  ///< e.g. "sweep 1 of 2"
};

struct RunReport {
  std::size_t frames = 0;                                   ///< read at least once
  std::size_t active_voxels = 0;                            ///< of the last output time
  std::size_t channels = 0;                                 ///< splatted per frame, over all sweeps
  std::size_t grids = 0;                                    ///< OpenVDB grids allocated over the run, the mask apart
  std::vector<std::pair<std::string, double>> seconds;      ///< wall time by step of the run: read, bin and splat, …
  std::vector<std::pair<std::string, std::size_t>> masked;  ///< reason → voxels, of the last output time
  std::vector<std::string> files;                           ///< written
  ReadCounters read;
};

/// What can only be checked once the dump is known: cutoff against periodic lengths, voxels against periods, frames
/// against the selection, extents against the limits, columns against the needs. Throws ConfigError, InputError or
/// LimitError. `grainvdb validate` calls it too. Returns the lattice with its periods.
Lattice check_against_input(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

/// Reads frame k with every column that the run will need, and makes the checks that the run makes of each frame before
/// it computes anything. Throws InputError, IoError or LimitError.
void check_frame(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source,
                 std::size_t k);

/// Runs the whole pipeline into the sinks. `progress` is called from the calling thread, after each frame.
RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::function<void(const Progress&)>& progress = {});

}  // namespace grainvdb
