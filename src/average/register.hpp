#pragma once
/// The standard errors of fields.
#include "grainvdb/stage.hpp"

namespace grainvdb {

/// `<name>_error` for fields that are smooth functions of the averages; they must be registered already.
void register_standard_errors(StageRegistry& registry);

}  // namespace grainvdb
