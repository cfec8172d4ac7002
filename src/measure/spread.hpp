#pragma once
/// The distribution of a quantity that is not negative.
#include <cmath>
#include <cstddef>
#include <vector>

namespace grainvdb {

/// Counts in bins of one width from 0 on, as many as it takes; mean and standard deviation of the values themselves.
class Spread {
 public:
  explicit Spread(double width) : width_(width) {}

  /// `x` ≥ 0 and finite.
  void add(double x) {
    const auto bin = static_cast<std::size_t>(x / width_);
    if (counts_.size() <= bin) counts_.resize(bin + 1);
    ++counts_[bin];
    ++n_;
    // Welford's running moments: sums of squares would cancel.
    const double before = x - mean_;
    mean_ += before / n_;
    squares_ += before * (x - mean_);
  }

  std::size_t bins() const { return counts_.size(); }
  /// Share of the values in bin k over its width.
  double density(std::size_t k) const { return k < bins() ? counts_[k] / (n_ * width_) : 0; }
  double count() const { return n_; }
  /// NaN without values.
  double mean() const { return n_ > 0 ? mean_ : std::nan(""); }
  double deviation() const { return std::sqrt(squares_ / n_); }

 private:
  double width_, n_ = 0, mean_ = 0, squares_ = 0;
  std::vector<double> counts_;
};

}  // namespace grainvdb
