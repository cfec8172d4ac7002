#pragma once
/// How the tracers of a pipeline get their output times: along with the fields that are written, or in a pass of their
/// own.
#include <functional>
#include <optional>
#include <vector>

#include "grainvdb/seeds.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/trace_run.hpp"

namespace grainvdb {

class TracePass {
 public:
  /// Makes the checks of the input, and the seeds. All arguments must outlive the pass. Throws ConfigError, InputError,
  /// IoError or LimitError.
  TracePass(const Pipeline& pipeline, const Plan& plan, FrameSource& source, const TraceRun::Sinks& sinks);

  /// Whether the output times are wanted in the order of time, each whole.
  bool goes_along() const { return !backward_; }
  void take(const OutputFields& output) {
    clock_.time("trace", [&] { run_.take(output); });
  }

  /// Computes the output times in the order that the tracers want: around the tracers alone, where the pipeline and the
  /// cost say so.
  RunReport compute(const std::function<void(const Progress&)>& progress);

  /// Puts the histories under their names and adds to the report.
  void commit(RunReport& report);

 private:
  using Show = std::function<void(const Progress&)>;
  RunReport compute_backward(const Show& progress);
  std::optional<RunReport> compute_nearby(const Show& progress);

  const Pipeline& pipeline_;
  const Plan& plan_;
  FrameSource& source_;
  bool backward_;  ///< through frames
  Lattice lattice_;
  std::vector<std::size_t> wanted_;
  TracerSeeds seeds_;
  TraceRun run_;
  Stopwatch clock_;
};

}  // namespace grainvdb
