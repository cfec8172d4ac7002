#pragma once
/// The subcommands of `grainvdb spot`.
#include <CLI/CLI.hpp>

namespace grainvdb::cli {

void add_spot_calibrate(CLI::App& spot);

}  // namespace grainvdb::cli
