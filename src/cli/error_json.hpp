#pragma once
#include <nlohmann/json.hpp>

#include "grainvdb/error.hpp"

namespace grainvdb::cli {

/// The parts of an error by name, for programs: kind (by exit code), file and line where known, what, found, expected
/// and hint where there are any, and the message as people read it.
nlohmann::ordered_json error_json(const Error& error);

}  // namespace grainvdb::cli
