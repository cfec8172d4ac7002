#pragma once
/// Standard errors of a series in time whose neighbours are not independent: by leaving out groups of successive ones.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "measure/estimate.hpp"
#include "measure/jackknife_error.hpp"

namespace grainvdb {

/// At most ten groups of at least two successive samples.
class TimeGroups {
 public:
  explicit TimeGroups(std::size_t samples) : samples_(samples), groups_(std::min<std::size_t>(10, samples / 2)) {}

  std::size_t count() const { return groups_; }
  std::size_t of(std::size_t sample) const { return groups_ == 0 ? 0 : sample * groups_ / samples_; }

 private:
  std::size_t samples_, groups_;
};

/// Whether a sample is kept.
using Keeps = std::function<bool(std::size_t)>;

/// f(keeps) of all samples, keeps(k) for each of them, and its error by the jackknife over groups; NaN for fewer than
/// two groups.
inline Estimate by_time_groups(std::size_t samples, const std::function<double(const Keeps&)>& f) {
  const TimeGroups groups(samples);
  std::vector<double> without;
  for (std::size_t g = 0; g < groups.count(); ++g)
    without.push_back(f([&](std::size_t k) { return groups.of(k) != g; }));
  return {f([](std::size_t) { return true; }), jackknife_error(without)};
}

/// NaN where none is kept.
inline double mean_of(const std::vector<double>& values, const Keeps& keeps) {
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!keeps(k)) continue;
    sum += values[k];
    ++n;
  }
  return sum / n;
}

inline Estimate mean_by_time_groups(const std::vector<double>& values) {
  return by_time_groups(values.size(), [&](const Keeps& keeps) { return mean_of(values, keeps); });
}

}  // namespace grainvdb
