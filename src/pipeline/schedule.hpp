#pragma once
/// In which order frames are visited: window by window, each swept as often as the plan asks. Where windows overlap the
/// first sweep visits only the frames that no window before has.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "average/time_windows.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// One visit of a frame.
struct Visit {
  std::size_t frame = 0;  ///< index into the source
  std::size_t sweep = 0;
  std::size_t window = 0;
  std::size_t place = 0;     ///< among the visits of its sweep over the window
  std::size_t block = 0;     ///< of its window; where windows overlap, a frame of the first sweep has none
  bool begins_part = false;  ///< the first of a part of the schedule
  bool ends_sweep = false;   ///< the last of its sweep over the window

  bool operator==(const Visit&) const = default;
};

/// What the pipeline says of output times, and of blocks where the plan has standard errors. Where averaging may stop
/// by itself blocks are no matter of the schedule: they grow.
TimeWindows time_windows(const Pipeline& pipeline, const Plan& plan);

/// The visits of a schedule for the frames `wanted`.
std::vector<Visit> schedule_visits(const WindowSchedule& schedule, std::span<const std::size_t> wanted,
                                   std::size_t sweeps);

/// How many visits of the first so many frames are the same however many frames come after them.
std::size_t certain_visits(const TimeWindows& windows, std::size_t frames, std::size_t sweeps);

/// How a schedule averages its frames, in words; also where it falls short of what the pipeline asks for.
std::string describe(const WindowSchedule& schedule, const Pipeline& pipeline);
/// From how many blocks standard errors are, in words; the schedule must be one with blocks.
std::string describe_blocks(const WindowSchedule& schedule);

/// Those of the frames `wanted` that are in any window.
std::vector<std::size_t> frames_of(const WindowSchedule& schedule, std::span<const std::size_t> wanted);

/// The frames of each output time.
std::vector<std::vector<std::size_t>> windows_of(const Pipeline& pipeline, std::span<const std::size_t> wanted);

}  // namespace grainvdb
