#include "pipeline/frame_range.hpp"

#include <algorithm>

#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

// A part of a range; an empty one is allowed and leaves `value` alone. False when it is not a sensible number.
bool read_part(std::string_view text, std::optional<std::int64_t>& value) {
  constexpr std::int64_t largest = 1'000'000'000'000;  // leaves room for sums
  if (text.empty()) return true;
  value = parse_integer(text);
  return value && std::abs(*value) <= largest;
}

}  // namespace

std::optional<FrameRange> parse_frame_range(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t colon = text.find(':', begin);
    parts.push_back(text.substr(begin, colon - begin));
    if (colon == std::string_view::npos) break;
    begin = colon + 1;
  }
  FrameRange range;
  std::optional<std::int64_t> step = 1;
  if (parts.size() > 3 || !read_part(parts[0], range.start)) return std::nullopt;
  if (parts.size() == 1) {
    if (!range.start) return std::nullopt;
    if (*range.start != -1) range.stop = *range.start + 1;  // the frame after -1 is the end
    return range;
  }
  if (!read_part(parts[1], range.stop)) return std::nullopt;
  if (parts.size() == 3 && (!read_part(parts[2], step) || *step < 1)) return std::nullopt;
  range.step = *step;
  return range;
}

std::vector<std::size_t> select_frames(const FrameRange& range, std::size_t n) {
  const auto count = static_cast<std::int64_t>(n);
  const auto bound = [&](std::int64_t i) { return std::clamp(i < 0 ? i + count : i, std::int64_t{0}, count); };
  std::vector<std::size_t> frames;
  const std::int64_t stop = range.stop ? bound(*range.stop) : count;
  for (std::int64_t i = range.start ? bound(*range.start) : 0; i < stop; i += range.step)
    frames.push_back(static_cast<std::size_t>(i));
  return frames;
}

}  // namespace grainvdb
