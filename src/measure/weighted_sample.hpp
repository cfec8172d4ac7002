#pragma once
/// Statistics of numbers that count unequally.
#include <cstddef>
#include <utility>
#include <vector>

namespace grainvdb {

class WeightedSample {
 public:
  /// Weights that are not positive and values that are NaN are left out.
  void add(double value, double weight);

  std::size_t size() const { return points_.size(); }
  /// Σw; 0 where there is nothing.
  double weight() const { return weight_; }
  /// (Σw)²/Σw²: as many equal weights tell as much.
  double effective_size() const { return squares_ > 0 ? weight_ * weight_ / squares_ : 0; }
  /// Σwx/Σw; NaN where there is nothing.
  double mean() const;
  /// √(Σw(x - mean)²/(Σw - Σw²/Σw)), which is unbiased in its square; NaN below two values.
  double spread() const;
  /// spread/√(effective_size · independence), with the part of a value that is independent of the others, 0 … 1; no
  /// larger than the spread.
  double mean_error(double independence) const;
  /// The value below which the share p of the weight lies, 0 ≤ p ≤ 1: linear between the values in ascending order,
  /// each at the middle of its own weight. NaN where there is nothing.
  double quantile(double p) const;

 private:
  std::vector<std::pair<double, double>> points_;
  double weight_ = 0, squares_ = 0;
};

}  // namespace grainvdb
