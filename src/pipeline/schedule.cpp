#include "pipeline/schedule.hpp"

#include <algorithm>
#include <numeric>

namespace grainvdb {
namespace {

/// The visits of one sweep over one window.
class SweepVisits {
 public:
  SweepVisits(const WindowSchedule& schedule, std::span<const std::size_t> wanted, std::vector<Visit>& visits)
      : schedule_(schedule), wanted_(wanted), visits_(visits) {}

  void add(std::size_t window, std::size_t sweep) {
    std::size_t part = schedule_.windows[window].first_part;
    std::size_t block = 0;
    place_ = 0;
    for (const std::size_t parts : schedule_.windows[window].blocks) {
      for (std::size_t k = 0; k < parts; ++k, ++part)
        if (sweep > 0 || part >= next_part_) add_part({.sweep = sweep, .window = window, .block = block}, part);
      ++block;
    }
    next_part_ = std::max(next_part_, part);
    visits_.back().ends_sweep = true;
  }

 private:
  void add_part(Visit visit, std::size_t part) {
    const FrameSpan& frames = schedule_.parts[part];
    visit.begins_part = true;
    for (std::size_t f = frames.first; f < frames.end(); ++f) {
      visit.frame = wanted_[f];
      visit.place = place_++;
      visits_.push_back(visit);
      visit.begins_part = false;
    }
  }

  const WindowSchedule& schedule_;
  std::span<const std::size_t> wanted_;
  std::vector<Visit>& visits_;
  std::size_t place_ = 0;
  std::size_t next_part_ = 0;  // that no window before has
};

}  // namespace

TimeWindows time_windows(const Pipeline& pipeline, const Plan& plan) {
  return {pipeline.window, pipeline.window_step, plan.errors.errors.empty() || pipeline.until ? 1 : pipeline.blocks};
}

std::vector<Visit> schedule_visits(const WindowSchedule& schedule, std::span<const std::size_t> wanted,
                                   std::size_t sweeps) {
  std::vector<Visit> visits;
  SweepVisits add(schedule, wanted, visits);
  for (std::size_t w = 0; w < schedule.windows.size(); ++w)
    for (std::size_t sweep = 0; sweep < sweeps; ++sweep) add.add(w, sweep);
  return visits;
}

std::size_t certain_visits(const TimeWindows& windows, std::size_t frames, std::size_t sweeps) {
  // How long blocks are depends on the number of frames.
  if (windows.blocks > 1 && windows.length == 0) return 0;
  const std::size_t further = frames + 2 * (windows.length + windows.step) + 1;
  std::vector<std::size_t> wanted(further);
  std::iota(wanted.begin(), wanted.end(), std::size_t{0});
  const WindowSchedule now = schedule_windows(windows, frames), later = schedule_windows(windows, further);
  if (now.overlapping != later.overlapping) return 0;
  const auto visits = schedule_visits(now, std::span(wanted).first(frames), sweeps);
  const auto visits_later = schedule_visits(later, wanted, sweeps);
  const auto is_whole = [&](std::size_t window) { return now.windows[window].frames.count == windows.length; };
  std::size_t n = 0;
  while (n < visits.size() && visits[n] == visits_later[n] && (windows.blocks == 1 || is_whole(visits[n].window))) ++n;
  return n;
}

std::string describe(const WindowSchedule& schedule, const Pipeline& pipeline) {
  const auto counted = [](std::size_t n, const char* noun) {
    return std::to_string(n) + ' ' + noun + (n == 1 ? "" : "s");
  };
  const FrameSpan& first = schedule.windows.front().frames;
  const FrameSpan& last = schedule.windows.back().frames;
  const std::size_t times = schedule.windows.size();
  std::string text = counted(times, "output time") + " of " + counted(first.count, "frame");
  if (times > 1 && schedule.windows[1].frames.first != first.count)
    text += ", one every " + counted(schedule.windows[1].frames.first, "frame");
  if (last.count < pipeline.window)
    text += std::string(times > 1 ? "; the last has only " + std::to_string(last.count) : "") +
            ", fewer than average.window = " + std::to_string(pipeline.window);
  return text;
}

std::string describe_blocks(const WindowSchedule& schedule) {
  const std::size_t blocks = schedule.windows.front().blocks.size();
  const std::size_t last = schedule.windows.back().blocks.size();
  std::string text = "standard errors from " + std::to_string(blocks) + " blocks of frames for each output time";
  if (last < 2) return text + ", but none for the last, which has only one frame";
  if (last < blocks) text += ", " + std::to_string(last) + " for the last";
  return text;
}

std::vector<std::size_t> frames_of(const WindowSchedule& schedule, std::span<const std::size_t> wanted) {
  std::vector<std::size_t> frames;
  for (const FrameSpan& part : schedule.parts)
    frames.insert(frames.end(), wanted.begin() + static_cast<std::ptrdiff_t>(part.first),
                  wanted.begin() + static_cast<std::ptrdiff_t>(part.end()));
  return frames;
}

std::vector<std::vector<std::size_t>> windows_of(const Pipeline& pipeline, std::span<const std::size_t> wanted) {
  std::vector<std::vector<std::size_t>> windows;
  const TimeWindows without_blocks{.length = pipeline.window, .step = pipeline.window_step};
  for (const Window& window : schedule_windows(without_blocks, wanted.size()).windows) {
    const auto frames = wanted.subspan(window.frames.first, window.frames.count);
    windows.emplace_back(frames.begin(), frames.end());
  }
  return windows;
}

}  // namespace grainvdb
