#pragma once
#include <memory>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb::cli {

/// What is read of the input of a pipeline: contact dumps are not even looked for when the plan needs none.
InputSpec needed_input(const Pipeline& pipeline, const Plan& plan);
/// The dumps of a pipeline; contact dumps are not even looked for when the plan needs none. Throws as open_dumps.
std::unique_ptr<FrameSource> open_input(const Pipeline& pipeline, const Plan& plan);

}  // namespace grainvdb::cli
