#include "grainvdb/trace_report.hpp"

#include "grainvdb/tracers.hpp"
#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

std::string counted(std::size_t n, const std::string& noun) {
  return std::to_string(n) + ' ' + noun + (n == 1 ? "" : "s");
}

std::string ending(TracerStop stop) {
  switch (stop) {
    case TracerStop::moving:
      return "moving to the end";
    case TracerStop::left_material:
      return "left the material";
    case TracerStop::left_domain:
      return "left the domain";
    case TracerStop::masked:
      break;
  }
  return "stopped where a recorded field is undefined";
}

std::string name_of(Reason reason) {
  for (const ReasonInfo& r : reasons())
    if (r.reason == reason) return std::string(r.name);
  return "other";
}

}  // namespace

std::vector<std::string> describe(const TraceReport& report) {
  std::string line = counted(report.tracers, "tracer") + ", " + counted(report.samples, "sample") + ": ";
  std::string between;
  for (const auto& [stop, n] : report.ended) {
    line += between + std::to_string(n) + ' ' + ending(stop);
    between = ", ";
  }
  std::vector<std::string> lines{line};
  if (!report.undefined.empty()) {
    line = "recorded fields were undefined for:";
    for (const auto& [reason, n] : report.undefined) line += ' ' + name_of(reason) + ' ' + std::to_string(n);
    lines.push_back(line);
  }
  lines.push_back("Co = |u| dt/h at most " + short_number(report.largest_courant) + ", K = |grad u| dt at most " +
                  short_number(report.largest_gradient_number) +
                  (report.through_frames ? " between output times" : " of a step"));
  if (report.nearby_passes > 0)
    lines.push_back("splatted around the tracers alone, in " +
                    (report.nearby_passes > 1 ? std::to_string(report.nearby_passes) + " passes" : "1 pass") +
                    " over the frames, the last of them " + short_number(100 * report.nearby_share) +
                    " % of the particles");
  if (!report.is_meaningful()) lines.push_back(trace_warning(report));
  return lines;
}

std::string trace_warning(const TraceReport& report) {
  if (report.is_meaningful()) return {};
  return "histories through frames are not meaningful here: of " + counted(report.moves, "move") +
         " from one output time to the next, " + std::to_string(report.above_gradient_limit) + " had K > " +
         short_number(report.limits.gradient_number) + " and " + std::to_string(report.above_courant_limit) +
         " had Co > " + short_number(report.limits.courant) +
         "; trace the time-mean field (trace.through: mean), or dump more often";
}

}  // namespace grainvdb
