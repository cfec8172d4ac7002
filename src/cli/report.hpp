#pragma once
#include <string>
#include <vector>

#include "grainvdb/run.hpp"

namespace grainvdb::cli {

/// What a run did, where its files are and how to look at them.
std::string describe(const RunReport& report);

/// What a user must not miss; empty where there is nothing of the kind.
std::string warnings(const RunReport& report);
/// The same of runs at several scales, by name. What is wrong with the input is the same for all, and said once.
std::string warnings(const std::vector<RunReport>& reports, const std::vector<std::string>& names);

/// "cutoff 3, voxel 0.5".
std::string scale_name(const Pipeline& pipeline);

}  // namespace grainvdb::cli
