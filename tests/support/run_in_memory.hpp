#pragma once
/// Pipelines without a file, run on frames in memory or on dumps, with the result kept in memory.
#include <string>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"
#include "support/memory_sink.hpp"

namespace grainvdb::testing {

/// A pipeline with the defaults of every stage.
Pipeline make_pipeline(double voxel, const Vec3& origin, double cutoff, std::vector<std::string> fields);

/// Sets an option of a stage; both must exist.
void set_option(Pipeline& pipeline, const std::string& stage, const std::string& name, OptionValue value);

/// Every field that the standard registry offers, the mask included, but no standard errors.
std::vector<std::string> all_fields();
/// Those.
std::vector<std::string> all_errors();

struct Result {
  Record record;
  RunReport report;
  Plan plan;

  /// What was written, when there is one output time.
  const Written& only() const;
};

Result run(const Pipeline& pipeline, FrameSource& source);
/// Runs on frames in memory; the pipeline is told that there are contacts, and those with walls where a frame has
/// any.
Result run(Pipeline pipeline, const std::vector<Frame>& frames);

/// Makes the tables of the measurements and writes no field.
RunReport measure(const Pipeline& pipeline, FrameSource& source);

}  // namespace grainvdb::testing
