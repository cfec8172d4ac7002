#pragma once
#include <string>

#include "grainvdb/run.hpp"

namespace grainvdb::cli {

/// What a run did, where its files are and how to look at them.
std::string describe(const RunReport& report);

/// What a user must not miss; empty where there is nothing of the kind.
std::string warnings(const RunReport& report);

}  // namespace grainvdb::cli
