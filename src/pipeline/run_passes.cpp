#include "pipeline/run_passes.hpp"

#include <utility>

#include "pipeline/stream.hpp"

namespace grainvdb {

RunReport make_passes(const RunPasses& passes, const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                      const std::function<void(const Progress&)>& progress) {
  RunReport report;
  if (passes.whole_fields) {
    const bool together = passes.tracers != nullptr && passes.tracers->goes_along();
    const auto take = [&](OutputFields output) {
      if (passes.measurements != nullptr) passes.measurements->take(output);
      if (together) passes.tracers->take(output);
      if (passes.fields) passes.fields(std::move(output));
    };
    report = stream_fields(pipeline, plan, source, take, progress, {}, passes.checkpoint);
    if (passes.tracers != nullptr && !together) passes.tracers->compute(progress);
  } else if (passes.tracers != nullptr) {
    report = passes.tracers->compute(progress);
  }
  if (passes.measurements != nullptr) passes.measurements->visit_frames(report, progress, passes.checkpoint);
  return report;
}

}  // namespace grainvdb
