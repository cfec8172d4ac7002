#pragma once
/// The standard errors of fields.
#include "grainvdb/stage.hpp"

namespace grainvdb {

/// `<name>_error` of a field that is a smooth function of the averages.
Stage standard_error_of(const Stage& field);

/// Those for fields that are smooth functions of the averages; they must be registered already.
void register_standard_errors(StageRegistry& registry);

}  // namespace grainvdb
