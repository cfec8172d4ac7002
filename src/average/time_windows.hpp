#pragma once
/// Which frames make an output time, and in which blocks they are summed: for windows that overlap, so that each frame
/// is summed once for all of them; for standard errors, so that blocks can be left out.
#include <cstddef>
#include <vector>

namespace grainvdb {

/// Windows of `length` frames, one beginning every `step` frames: fewer than `length` make sliding windows, more leave
/// frames out between them. Windows follow one another until one reaches the last frame; it alone may be shorter.
struct TimeWindows {
  std::size_t length = 0;  ///< 0: all frames in one
  std::size_t step = 0;    ///< 0: as length
  std::size_t blocks = 1;  ///< that a window is to be made of at least, if it has so many frames

  bool operator==(const TimeWindows&) const = default;
};

/// Successive frames.
struct FrameSpan {
  std::size_t first = 0;
  std::size_t count = 0;
  std::size_t end() const { return first + count; }
  bool operator==(const FrameSpan&) const = default;
};

/// One output time.
struct Window {
  FrameSpan frames;
  std::size_t first_part = 0;
  /// How many successive parts, from first_part on, make each block.
  std::vector<std::size_t> blocks;

  std::size_t part_count() const;
};

struct WindowSchedule {
  std::vector<FrameSpan> parts;  ///< in ascending order; no frame is in two of them
  std::vector<Window> windows;   ///< in ascending order
  bool overlapping = false;      ///< parts belong to several windows

  /// Frames that are in a window.
  std::size_t frame_count() const;
  /// The most parts of which any window is made.
  std::size_t most_parts() const;
  /// The most blocks of any window.
  std::size_t most_blocks() const;
};

/// The parts of which a window that slides is made; 0 where windows do not overlap.
std::size_t shared_parts(const TimeWindows& windows);

/// Blocks of a window are of equal length as nearly as possible; where windows overlap, as far as the parts that they
/// share allow.
WindowSchedule schedule_windows(const TimeWindows& windows, std::size_t frames);

}  // namespace grainvdb
