#pragma once
/// What a run would come to, from one frame of it.
#include <string>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb::cli {

/// Makes the checks of a run, computes the first frame that can be used alone, and says in words what all frames would
/// take. Throws what the run would throw before its second frame.
std::string estimate(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

}  // namespace grainvdb::cli
