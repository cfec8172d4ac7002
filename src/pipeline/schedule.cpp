#include "pipeline/schedule.hpp"

#include <algorithm>

namespace grainvdb {
namespace {

std::size_t frames_per_window(const Pipeline& pipeline, std::size_t frames) {
  return pipeline.window == 0 ? frames : std::min(pipeline.window, frames);
}

}  // namespace

std::size_t window_count(const Pipeline& pipeline, std::size_t frames) {
  const std::size_t per_window = frames_per_window(pipeline, frames);
  return (frames + per_window - 1) / per_window;
}

std::vector<Visit> schedule_visits(const Pipeline& pipeline, std::span<const std::size_t> wanted, std::size_t sweeps) {
  const std::size_t per_window = frames_per_window(pipeline, wanted.size());
  std::vector<Visit> visits;
  visits.reserve(wanted.size() * sweeps);
  for (std::size_t first = 0; first < wanted.size(); first += per_window) {
    const auto window = wanted.subspan(first, std::min(per_window, wanted.size() - first));
    for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
      for (const std::size_t frame : window) visits.push_back({frame, sweep});
      visits.back().ends_sweep = true;
    }
    visits.back().ends_window = true;
  }
  return visits;
}

}  // namespace grainvdb
