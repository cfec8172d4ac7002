#pragma once
/// What became of the tracers of a run.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/mask.hpp"
#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

struct TraceReport {
  bool through_frames = false;
  StepLimits limits{};
  std::size_t tracers = 0;
  std::size_t samples = 0;
  std::size_t steps = 0;                    ///< of the integration, over all tracers
  std::map<TracerStop, std::size_t> ended;  ///< tracers by what they do at the end
  std::map<Reason, std::size_t> undefined;  ///< why recorded fields stopped tracers or left NaN, over all samples
  std::size_t moves = 0;                    ///< of one tracer from one sample or output time to the next
  std::size_t above_courant_limit = 0;      ///< of these moves
  std::size_t above_gradient_limit = 0;     ///< of these moves
  double largest_courant = 0;               ///< Co = |u|Δt/h
  double largest_gradient_number = 0;       ///< K = |∇u|Δt
  std::size_t nearby_passes = 0;            ///< over the frames, that splatted only what tracers may come to
  double nearby_share = 0;                  ///< of the particles that the last of these splatted
  std::vector<std::string> files;           ///< written

  /// Whether histories mean something: always through the mean; through frames when Co and K keep
  /// within their limits in every move.
  bool is_meaningful() const { return !through_frames || (above_courant_limit == 0 && above_gradient_limit == 0); }
};

/// The report in words, line by line: for the summary of a run and the provenance.
std::vector<std::string> describe(const TraceReport& report);

/// Why histories are not meaningful, and what to do; empty where they are.
std::string trace_warning(const TraceReport& report);

}  // namespace grainvdb
