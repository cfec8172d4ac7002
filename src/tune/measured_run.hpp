#pragma once
/// One run of a pipeline with all that is compared of it; nothing is written.
#include <cstddef>
#include <functional>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/table.hpp"
#include "tune/field_error.hpp"
#include "tune/tracer_error.hpp"

namespace grainvdb {

struct MeasuredRun {
  FieldSet fields;  ///< of the last output time
  std::vector<Table> tables{};
  TracerPaths tracers{};
};

/// The lattice of fields or planes. Throws as the checks against the input do.
Lattice checked_lattice_of(const Pipeline& pipeline, const Plan& plan, FrameSource& source);

/// Throws what run_pipeline throws.
MeasuredRun measured_run(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                         const std::function<void(const Progress&)>& progress);

}  // namespace grainvdb
