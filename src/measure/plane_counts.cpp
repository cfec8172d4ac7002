#include "measure/plane_counts.hpp"

#include <numeric>

#include "measure/time_groups.hpp"
#include "measure/weighted_line.hpp"

namespace grainvdb {

void PlaneCounts::add(const Frame& frame) {
  if (!frame.time) return;
  times_.push_back(*frame.time);
  std::vector<double>& above = above_.emplace_back(heights_.size());
  for (const double x : frame.particles.position[up_])
    for (std::size_t plane = 0; plane < heights_.size(); ++plane) above[plane] += x >= heights_[plane] ? 1 : 0;
}

Estimate PlaneCounts::rate_of(const std::vector<double>& grains) const {
  if (times_.size() < 2) return {};
  return by_time_groups(times_.size(), [&](const Keeps& keeps) {
    std::vector<double> t, n;
    for (std::size_t k = 0; k < times_.size(); ++k) {
      if (!keeps(k)) continue;
      t.push_back(times_[k]);
      n.push_back(grains[k]);
    }
    return -weighted_line(t, n).slope;
  });
}

Estimate PlaneCounts::rate(std::size_t plane) const {
  std::vector<double> grains;
  for (const auto& above : above_) grains.push_back(above[plane]);
  return rate_of(grains);
}

Estimate PlaneCounts::mean_rate() const {
  std::vector<double> grains;
  for (const auto& above : above_)
    grains.push_back(std::accumulate(above.begin(), above.end(), 0.0) / static_cast<double>(heights_.size()));
  return rate_of(grains);
}

}  // namespace grainvdb
