#pragma once
#include <string>

#include "grainvdb/run.hpp"

namespace grainvdb::cli {

/// What a run did, where its files are and how to look at them.
std::string describe(const RunReport& report);

}  // namespace grainvdb::cli
