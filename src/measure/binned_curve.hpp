#pragma once
/// Points (x, y) in bins of x, and how well x tells y.
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace grainvdb {

/// Mean and sum of squares about it, by updates that do not cancel.
class RunningMoments {
 public:
  void add(double value);
  std::size_t count() const { return count_; }
  double mean() const { return mean_; }
  double squares() const { return squares_; }  ///< Σ(y - mean)²
  /// √(squares/(count - 1)); NaN below two values.
  double spread() const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// Bins lie at whole multiples of their width, so that those of several runs are the same.
class BinnedCurve {
 public:
  struct Bin {
    double x = 0;  ///< its centre
    RunningMoments y;
  };

  /// Throws std::invalid_argument unless width > 0.
  explicit BinnedCurve(double width);

  /// Points of which a number is not finite are left out.
  void add(double x, double y);

  /// Those that hold a point, in ascending order of x.
  std::vector<Bin> bins() const;
  std::size_t count() const { return all_.count(); }
  /// The standard deviation of y.
  double spread() const { return all_.spread(); }
  /// The scatter of y about the mean of its bin, √(Σ(y - mean of bin)²/(points - bins)); NaN without a point to spare.
  double scatter() const;
  /// 1 - scatter²/spread²: the part of the variance of y that x tells. 1 where y is the same all over each bin; 0, on
  /// average, where x tells nothing: there its standard deviation is √(2(B-1)/((n-B)(n+1))) for normal y, n points and
  /// B bins. A straight line is 1 - 1/B² for even bins.
  double collapse() const;
  /// That standard deviation.
  double collapse_noise() const;

 private:
  double width_;
  RunningMoments all_;
  std::map<std::int64_t, RunningMoments> bins_;
};

}  // namespace grainvdb
