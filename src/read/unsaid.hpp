#pragma once
/// What some formats leave unsaid, from the input.
#include <string>

#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

/// Puts into a header what the input says in place of the file: names of columns, periodic axes, bounds of the box.
/// Throws ConfigError where the input does not say it either, or gives another number of columns than the rows have.
void complete(FrameHeader& header, const InputSpec& spec, const std::string& file);

/// Throws ConfigError where what the input says of the box cannot be meant.
void check_box(const InputSpec& spec);

}  // namespace grainvdb
