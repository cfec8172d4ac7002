#pragma once
/// A run with its sinks.
#include <functional>
#include <memory>
#include <vector>

#include "grainvdb/run.hpp"
#include "pipeline/checkpoint.hpp"

namespace grainvdb {

struct RunSinks {
  const std::vector<std::unique_ptr<FieldSink>>& fields;
  const std::vector<std::unique_ptr<TracerSink>>& tracers;
};

/// As run_pipeline, with a checkpoint (nullptr: none), which is removed in the end.
RunReport run_into(const RunSinks& to, const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                   const std::function<void(const Progress&)>& progress, Checkpoint* checkpoint);

}  // namespace grainvdb
