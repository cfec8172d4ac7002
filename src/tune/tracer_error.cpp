#include "tune/tracer_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "measure/grains.hpp"
#include "pipeline/material.hpp"
#include "pipeline/no_material.hpp"
#include "pipeline/unless_bad.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t most_tracers = 10'000;

/// The last two samples of the same time, to rounding, behind the first.
std::optional<std::pair<std::size_t, std::size_t>> last_common(const TracerPaths& a, const TracerPaths& b) {
  if (a.time.empty() || b.time.empty()) return std::nullopt;
  const double near = 1e-9 * std::abs(a.time.back() - a.time.front());
  for (std::size_t i = a.time.size(); i-- > 1;)
    for (std::size_t j = b.time.size(); j-- > 1;)
      if (std::abs(a.time[i] - b.time[j]) <= near) return std::pair{i, j};
  return std::nullopt;
}

}  // namespace

void PathSink::write(const TracerSample& sample) {
  const std::size_t count = sample.stop.size();
  const std::size_t step = std::max<std::size_t>(1, (count + most_tracers - 1) / most_tracers);
  to_.time.push_back(sample.time);
  Columns3& displacement = to_.displacement.emplace_back();
  std::vector<TracerStop>& stop = to_.stop.emplace_back();
  for (std::size_t i = 0; i < count; i += step) {
    for (std::size_t a = 0; a < 3; ++a) displacement[a].push_back(sample.displacement[a][i]);
    stop.push_back(sample.stop[i]);
  }
}

FieldError position_error(const TracerPaths& reference, const TracerPaths& found, double diameter) {
  FieldError error{"position"};
  const auto common = last_common(reference, found);
  if (!common) return error;
  const auto& [at, now] = *common;
  double sum = 0;
  for (std::size_t i = 0; i < reference.stop[at].size(); ++i) {
    if (reference.stop[at][i] != TracerStop::moving) continue;
    if (found.stop[now][i] != TracerStop::moving) {
      ++error.undefined;
      continue;
    }
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a)
      square += std::pow(found.displacement[now][a][i] - reference.displacement[at][a][i], 2);
    ++error.points;
    sum += square;
    error.largest = std::max(error.largest, std::sqrt(square) / diameter);
  }
  if (error.points > 0) error.rms = std::sqrt(sum / static_cast<double>(error.points)) / diameter;
  return error;
}

double mean_diameter_of(const Pipeline& pipeline, FrameSource& source) {
  const std::vector<std::size_t> frames = select_frames(pipeline.frames, source.frames().size());
  for (const std::size_t k : frames) {
    auto frame = read_unless_bad(pipeline.input, source, k, Column::radius | Column::type);
    if (!frame) continue;
    apply_selection(pipeline.select, frame->box, frame->particles);
    const std::vector<double>& radius = frame->particles.radius;
    if (!radius.empty()) return mean_diameter(radius);
  }
  refuse_no_material(pipeline, source, frames);
}

}  // namespace grainvdb
