#pragma once
#include <CLI/CLI.hpp>

#include "grainvdb/frame_source.hpp"

namespace grainvdb::cli {

/// The dumps, and what they may leave unsaid, as the commands take them that need no pipeline file.
void add_input_options(CLI::App& command, InputSpec& input);

}  // namespace grainvdb::cli
