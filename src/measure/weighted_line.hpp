#pragma once
/// The straight line through weighted points.
#include <span>

namespace grainvdb {

/// y(x) = y_mean + slope (x - x_mean).
struct WeightedLine {
  double x_mean;
  double y_mean;
  double slope;
  double chi_square;  ///< Σ ((y_k - y(x_k))/σ_k)²

  double at(double x) const { return y_mean + slope * (x - x_mean); }
};

/// Minimises χ², with equal σ_k where `error` is empty. The slope is NaN where all x are the same.
WeightedLine weighted_line(std::span<const double> x, std::span<const double> y, std::span<const double> error = {});

}  // namespace grainvdb
