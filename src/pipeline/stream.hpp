#pragma once
/// The streaming executor.
#include <cstddef>
#include <functional>
#include <optional>

#include "grainvdb/run.hpp"
#include "pipeline/checkpoint.hpp"

namespace grainvdb {

/// As compute_fields. With a checkpoint (nullptr: none) output times that it has are handed over first, and the run
/// goes on behind the frames that are summed already.
RunReport stream_fields(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                        const std::function<void(OutputFields)>& take,
                        const std::function<void(const Progress&)>& progress, const std::optional<Region>& region,
                        Checkpoint* checkpoint);

/// Goes on with what is certain while further frames are to come, and saves it. Returns the visits of frames that are
/// done.
std::size_t stream_certain(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                           const std::function<void(const Progress&)>& progress, Checkpoint& checkpoint);

}  // namespace grainvdb
