#pragma once
#include <string>

#include "grainvdb/run.hpp"

namespace grainvdb::cli {

/// What the run took, as `run.json` in the output folder: seconds, by step too, and memory. It stands apart from the
/// results, whose bytes are the same for every run of a pipeline on its dumps. Throws IoError.
void write_run_record(const RunReport& report, const std::string& folder);

}  // namespace grainvdb::cli
