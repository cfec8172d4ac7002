#include "average/time_windows.hpp"

#include <algorithm>
#include <numeric>

namespace grainvdb {
namespace {

/// n in k numbers that differ by one at most.
std::vector<std::size_t> split(std::size_t n, std::size_t k) {
  std::vector<std::size_t> sizes;
  for (std::size_t j = 0; j < k; ++j) sizes.push_back(n * (j + 1) / k - n * j / k);
  return sizes;
}

void add_parts(std::vector<FrameSpan>& parts, const FrameSpan& frames, std::size_t count) {
  std::size_t first = frames.first;
  for (const std::size_t n : split(frames.count, count)) {
    parts.push_back({first, n});
    first += n;
  }
}

std::vector<FrameSpan> window_frames(std::size_t length, std::size_t step, std::size_t frames) {
  std::vector<FrameSpan> windows;
  for (std::size_t first = 0; first < frames && (windows.empty() || windows.back().end() < frames); first += step)
    windows.push_back({first, std::min(length, frames - first)});
  return windows;
}

/// Windows that slide begin and end on the borders of cells of so many frames.
std::size_t cell_of(const TimeWindows& w) {
  return std::gcd(w.length, w.step);
}
/// The parts of a cell: one, or more where blocks must be shorter.
std::size_t parts_of_cell(const TimeWindows& w) {
  return std::min(cell_of(w), (w.blocks * cell_of(w) + w.length - 1) / w.length);
}

WindowSchedule sliding(const std::vector<FrameSpan>& windows, const TimeWindows& wanted) {
  WindowSchedule schedule;
  schedule.overlapping = true;
  const std::size_t cell = cell_of(wanted);
  const std::size_t end = windows.back().end();
  for (std::size_t first = 0; first < end; first += cell) {
    const FrameSpan frames{first, std::min(cell, end - first)};
    add_parts(schedule.parts, frames, std::min(parts_of_cell(wanted), frames.count));
  }
  for (const FrameSpan& frames : windows) {
    const auto begins_at = [&](std::size_t frame) {
      return std::lower_bound(schedule.parts.begin(), schedule.parts.end(), frame,
                              [](const FrameSpan& part, std::size_t f) { return part.first < f; });
    };
    const auto first = begins_at(frames.first);
    const auto count = static_cast<std::size_t>(begins_at(frames.end()) - first);
    schedule.windows.push_back({frames, static_cast<std::size_t>(first - schedule.parts.begin()),
                                split(count, std::min(wanted.blocks, count))});
  }
  return schedule;
}

}  // namespace

std::size_t Window::part_count() const {
  return std::accumulate(blocks.begin(), blocks.end(), std::size_t{0});
}

std::size_t WindowSchedule::frame_count() const {
  return std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                         [](std::size_t n, const FrameSpan& part) { return n + part.count; });
}

std::size_t WindowSchedule::most_parts() const {
  std::size_t most = 0;
  for (const Window& w : windows) most = std::max(most, w.part_count());
  return most;
}

std::size_t WindowSchedule::most_blocks() const {
  std::size_t most = 0;
  for (const Window& w : windows) most = std::max(most, w.blocks.size());
  return most;
}

std::size_t shared_parts(const TimeWindows& w) {
  return w.step > 0 && w.step < w.length ? w.length / cell_of(w) * parts_of_cell(w) : 0;
}

WindowSchedule schedule_windows(const TimeWindows& windows, std::size_t frames) {
  const std::size_t length = windows.length == 0 ? frames : windows.length;
  const std::size_t step = windows.step == 0 ? length : windows.step;
  const std::vector<FrameSpan> spans = window_frames(length, step, frames);
  if (shared_parts(windows) > 0 && spans.size() > 1) return sliding(spans, windows);
  WindowSchedule schedule;
  for (const FrameSpan& span : spans) {
    const std::size_t blocks = std::min(windows.blocks, span.count);
    schedule.windows.push_back({span, schedule.parts.size(), std::vector<std::size_t>(blocks, 1)});
    add_parts(schedule.parts, span, blocks);
  }
  return schedule;
}

}  // namespace grainvdb
