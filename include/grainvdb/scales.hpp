#pragma once
/// One pipeline at several scales, for which every frame is read only once.
#include <functional>
#include <memory>
#include <vector>

#include "grainvdb/run.hpp"

namespace grainvdb {

/// A run among several: the pipeline at its scale, and where its results go.
struct ScaleRun {
  Pipeline pipeline;
  Plan plan;
  std::vector<std::unique_ptr<FieldSink>> sinks;
  std::vector<std::unique_ptr<TracerSink>> tracer_sinks{};
};

/// The pipeline at each of its scales; alone where it has none. Tracers get whole grids
/// (TraceSpec::Neighbourhood::never), so that every scale reads the same frames.
std::vector<Pipeline> at_scales(const Pipeline& pipeline);

/// As run_pipeline for each of the runs, with the same results, to the last bit. They go side by side: none is more
/// than limits.frames_in_flight of the first ahead of another, and so many more frames are in memory. What fails in one
/// ends all, and is thrown. The pipelines must differ in voxel and cutoff alone. Each report has what was read for all
/// and the memory of all.
std::vector<RunReport> run_scales(std::vector<ScaleRun>& runs, FrameSource& source,
                                  const std::function<void(const Progress&)>& progress = {});

}  // namespace grainvdb
