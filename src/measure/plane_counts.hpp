#pragma once
/// How many grains are above planes, frame by frame, and how fast their number falls.
#include <cstddef>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/estimate.hpp"

namespace grainvdb {

class PlaneCounts {
 public:
  /// Planes across the axis `up`, at these heights [length].
  PlaneCounts(std::size_t up, std::vector<double> heights) : up_(up), heights_(std::move(heights)) {}

  /// A frame without a time counts for nothing.
  void add(const Frame& frame);

  const std::vector<double>& heights() const { return heights_; }
  const std::vector<double>& times() const { return times_; }
  /// Of one frame and plane: the grains whose centre is at that height or above.
  double above(std::size_t frame, std::size_t plane) const { return above_[frame][plane]; }

  /// Grains that pass down through a plane per time: less the slope of the line through their number above it against
  /// time, with its error by groups of frames (see time_groups.hpp). NaN for fewer than two frames.
  Estimate rate(std::size_t plane) const;
  /// The mean over the planes.
  Estimate mean_rate() const;

 private:
  Estimate rate_of(const std::vector<double>& grains) const;

  std::size_t up_;
  std::vector<double> heights_;
  std::vector<double> times_;
  std::vector<std::vector<double>> above_;  ///< [frame][plane]
};

}  // namespace grainvdb
