#pragma once
/// Where a result comes from.
#include <span>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// `wanted` are the frames that the pipeline selects.
Provenance provenance_of(const Pipeline& pipeline, const Plan& plan, const FrameSource& source,
                         std::span<const std::size_t> wanted);

}  // namespace grainvdb
