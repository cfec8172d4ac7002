#pragma once
#include <string>

#include "pipeline/schema.hpp"

namespace grainvdb::spot {

/// The declaration of spot files.
Schema make_spot_schema();

/// The JSON schema of spot files, made from it.
std::string spot_file_schema();

}  // namespace grainvdb::spot
