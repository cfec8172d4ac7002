#pragma once
#include <string>

#include "grainvdb/run.hpp"

namespace grainvdb::cli {

/// Writes the tables of a run in all formats, and adds the files to its report. Throws IoError.
void write_tables(RunReport& report, const std::string& folder);

}  // namespace grainvdb::cli
