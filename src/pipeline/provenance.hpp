#pragma once
/// Where a result comes from.
#include <span>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"

namespace grainvdb {

/// `frames` are those that were averaged, and bad ones among them.
Provenance provenance_of(const Pipeline& pipeline, const Plan& plan, const FrameSource& source,
                         std::span<const std::size_t> frames, const RunReport& report);

}  // namespace grainvdb
