#pragma once
/// Checks that both sides of a comparison do the same work. Each is made once, outside the time; one that fails makes
/// the program fail.
#include <functional>
#include <string>

namespace grainvdb::bench {

/// Runs `disagreement` unless a check of this name was made before: at most 1 if the results agree. Prints and
/// remembers a failure. Returns whether the results agree.
bool check_once(const std::string& name, const std::function<double()>& disagreement);

/// Whether all checks made so far succeeded.
bool all_checks_succeeded();

}  // namespace grainvdb::bench
