#pragma once
#include "pipeline/schema.hpp"

namespace grainvdb::spot {

/// The declaration of spot files.
Schema make_spot_schema();

}  // namespace grainvdb::spot
