#pragma once
/// Sums by bin and time, and what is formed of them with its standard error.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "measure/estimate.hpp"

namespace grainvdb {

/// f(nothing) with the standard error from f without each of `times` samples in time, θ_t = f(t):
/// s² = (n-1)/n Σ (θ_t - θ̄)², which is that of the mean where f is a mean. It takes the samples for independent. `f`
/// fills its last argument, of the length `outputs`. The errors are NaN for fewer than two samples.
std::vector<Estimate> jackknife(std::size_t times, std::size_t outputs,
                                const std::function<void(std::optional<std::size_t> without, std::span<double>)>& f);

/// Sums of several channels for each bin and time. Averages over time add these first and form ratios afterwards
/// (physics section 1).
class TimeSums {
 public:
  explicit TimeSums(std::size_t channels) : channels_(channels) {}

  void begin_time() { ++times_; }
  std::size_t times() const { return times_; }

  /// The sums of a bin at the time that was begun last, zero at first.
  std::span<double> at(std::int64_t bin);
  /// The bins that there are, in ascending order.
  std::vector<std::int64_t> bins() const;
  /// The sums over all times, or over all but one.
  std::vector<double> total(std::int64_t bin, std::optional<std::size_t> without = {}) const;

 private:
  std::size_t channels_;
  std::size_t times_ = 0;
  std::map<std::int64_t, std::vector<double>> sums_;  // [bin][time][channel], short where the last times have none
};

}  // namespace grainvdb
