#pragma once
/// The text form of a range of frames.
#include <optional>
#include <string_view>

#include "grainvdb/pipeline.hpp"

namespace grainvdb {

/// "7" is one frame; "a:b" and "a:b:c" are Python slices, each part may be left out. Nothing when the text is none of
/// these or the step is not positive.
std::optional<FrameRange> parse_frame_range(std::string_view text);

}  // namespace grainvdb
