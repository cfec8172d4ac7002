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

/// What two runs must have in common to give the same results: the beginning of the provenance.
std::vector<std::pair<std::string, std::string>> key_of_run(const Pipeline& pipeline, const FrameSource& source);
/// The same for inputs that grow: the version and the pipeline.
std::vector<std::pair<std::string, std::string>> key_of_run(const Pipeline& pipeline);

}  // namespace grainvdb
