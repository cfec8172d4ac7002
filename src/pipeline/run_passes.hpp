#pragma once
/// The passes over the frames that a run makes: for fields, with which tracers go along where they can, and for what is
/// measured of frames.
#include <functional>

#include "grainvdb/run.hpp"
#include "pipeline/checkpoint.hpp"
#include "pipeline/measure_pass.hpp"
#include "pipeline/trace_pass.hpp"

namespace grainvdb {

/// Who takes what; nullptr and an empty function: nobody.
struct RunPasses {
  MeasurePass* measurements = nullptr;
  TracePass* tracers = nullptr;
  std::function<void(OutputFields)> fields{};  ///< the last to take them
  bool whole_fields = true;                    ///< whether these are computed where tracers do not come to, too
  Checkpoint* checkpoint = nullptr;
};

/// What was gathered is not committed yet.
RunReport make_passes(const RunPasses& passes, const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                      const std::function<void(const Progress&)>& progress);

}  // namespace grainvdb
