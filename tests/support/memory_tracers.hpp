#pragma once
/// Histories of tracers that are kept in memory for the tests to look at.
#include <memory>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/tracer_sink.hpp"
#include "support/memory_sink.hpp"

namespace grainvdb::testing {

/// What a run of tracers made.
struct Histories {
  TracerLayout layout;
  std::vector<TracerSample> samples;
  Provenance provenance;
  RunReport report;
  Record fields;  ///< of a run that writes fields as well

  /// Unwrapped displacement of a tracer at the last sample.
  Vec3 displacement(std::size_t tracer) const;
  std::string provenance_text(const std::string& key) const;
};

/// Runs the tracers of a pipeline, and writes its fields where it names any.
Histories trace(const Pipeline& pipeline, FrameSource& source);
/// On frames in memory; the pipeline is told that there are contacts.
Histories trace(Pipeline pipeline, const std::vector<Frame>& frames);

/// Whether two runs gave the same bytes.
bool same_histories(const Histories& a, const Histories& b);

}  // namespace grainvdb::testing
