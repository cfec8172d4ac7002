#pragma once
/// Shares of weight in equal bins.
#include <cstddef>
#include <vector>

namespace grainvdb {

class Histogram {
 public:
  /// `bins` ≥ 1 equal bins over lo < hi. Throws std::invalid_argument otherwise.
  Histogram(double lo, double hi, std::size_t bins);

  /// NaN and weights that are not positive are left out. What lies outside counts in the total; hi itself lies in the
  /// last bin.
  void add(double value, double weight);

  std::size_t bins() const { return weights_.size(); }
  double lower(std::size_t bin) const { return lo_ + static_cast<double>(bin) * width_; }
  double centre(std::size_t bin) const { return lo_ + (static_cast<double>(bin) + 0.5) * width_; }
  /// The share of the total weight in a bin, divided by its width: ∫ density = 1 - outside(). NaN without any weight.
  double density(std::size_t bin) const;
  /// The share of the total weight outside all bins; NaN without any weight.
  double outside() const;
  std::vector<double> centres() const;
  std::vector<double> densities() const;

 private:
  double lo_, width_;
  std::vector<double> weights_;
  double total_ = 0, outside_ = 0;
};

}  // namespace grainvdb
