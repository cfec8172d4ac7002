#include "measure/weighted_sample.hpp"

#include <algorithm>
#include <cmath>

#include "base/nan.hpp"

namespace grainvdb {
namespace {}  // namespace

void WeightedSample::add(double value, double weight) {
  if (std::isnan(value) || !(weight > 0)) return;
  points_.emplace_back(value, weight);
  weight_ += weight;
  squares_ += weight * weight;
}

double WeightedSample::mean() const {
  double sum = 0;
  for (const auto& [value, weight] : points_) sum += weight * value;
  return points_.empty() ? nan : sum / weight_;
}

double WeightedSample::spread() const {
  if (points_.size() < 2) return nan;
  const double middle = mean();
  double sum = 0;
  for (const auto& [value, weight] : points_) sum += weight * (value - middle) * (value - middle);
  return std::sqrt(sum / (weight_ - squares_ / weight_));
}

double WeightedSample::mean_error(double independence) const {
  return spread() / std::sqrt(std::max(1.0, effective_size() * independence));
}

double WeightedSample::quantile(double p) const {
  if (points_.empty()) return nan;
  std::vector<std::pair<double, double>> sorted = points_;
  std::sort(sorted.begin(), sorted.end());
  const double wanted = p * weight_;
  double below = 0;  // the weight before the middle of the value at hand
  double last_place = 0;
  double last_value = sorted.front().first;
  for (const auto& [value, weight] : sorted) {
    const double place = below + weight / 2;
    if (place >= wanted)
      return place > last_place ? last_value + (value - last_value) * (wanted - last_place) / (place - last_place)
                                : value;
    last_place = place;
    last_value = value;
    below += weight;
  }
  return last_value;
}

}  // namespace grainvdb
