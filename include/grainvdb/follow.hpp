#pragma once
/// Runs a pipeline while its input is being written.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "grainvdb/followed_input.hpp"
#include "grainvdb/run.hpp"

namespace grainvdb {

/// When to stop waiting for frames, at the first that applies; one must be given.
struct FollowOptions {
  std::optional<std::int64_t> last_step;  ///< with the frame of this step, or a later one; what comes after it is left
  std::optional<double> timeout;          ///< when no frame has come for so long [s]
  double interval = 1;                    ///< from one look to the next [s]
};

/// Sums frames as they come and writes the results, which are those of run_pipeline on the same frames, in the end. In
/// between everything is kept in the checkpoint, from which an interrupted run goes on. What ends with the timeout
/// takes the input as it is then, with the errors that run_pipeline has for it. Throws ConfigError for frames that are
/// counted from the end, which is not known, and InputError where frames come before some that were summed.
RunReport follow_pipeline(const Pipeline& pipeline, const Plan& plan, FollowedInput& input,
                          const std::vector<std::unique_ptr<FieldSink>>& sinks,
                          const std::vector<std::unique_ptr<TracerSink>>& tracer_sinks, const FollowOptions& options,
                          const CheckpointOptions& checkpoint,
                          const std::function<void(const Progress&)>& progress = {});

}  // namespace grainvdb
