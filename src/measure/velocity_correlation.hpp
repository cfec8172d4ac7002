#pragma once
/// How far apart grains still move together.
#include <array>
#include <cstddef>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/slabs.hpp"

namespace grainvdb {

/// C(r) = ⟨u'(0)·u'(r)⟩/√(⟨u'(0)²⟩⟨u'(r)²⟩), means over the pairs of grains at a distance r, by their nearest images.
class VelocityCorrelation {
 public:
  VelocityCorrelation(double reach, std::size_t bins);

  /// One frame more: grains with their velocity fluctuations. `slabs` are those of all frames. The same bits for any
  /// number of threads.
  void add(const Box& box, const Columns3& position, const Columns3& fluctuation, const Slabs& slabs);

  std::size_t bins() const { return bins_; }
  double middle(std::size_t k) const;
  std::size_t pairs(std::size_t k) const;
  /// NaN where no pair is.
  double c(std::size_t k) const;
  /// By leaving out slabs; see jackknife_error.
  double error(std::size_t k) const;
  /// C without the pairs whose first grain lies in a slab. Empty where that slab has none: it is no group.
  std::vector<double> without(std::size_t slab) const;

 private:
  struct Sums {
    double product = 0, first = 0, second = 0;
    std::size_t pairs = 0;

    Sums& operator+=(const Sums& more);
  };
  Sums sum(std::size_t k, std::size_t without = Slabs::count) const;

  double reach_;
  std::size_t bins_;
  std::array<std::vector<Sums>, Slabs::count> slabs_;
};

/// 1 - 3r/4R + r³/16R³ for r < 2R, else 0: the common part of two balls of radius R at a distance r. It is C(r) of
/// grains each of which follows the mean of all spots within R of it, spots that move independently of each other.
double sphere_law(double r, double radius);

/// The fit of A (1 - 3r/4R + r³/16R³) by least squares, all points alike; NaN where the data do not determine it (see
/// least_squares), as of fewer than three points.
struct SphereFit {
  double amplitude = 0;
  double radius = 0;  ///< [length]
};
SphereFit fit_sphere_law(const std::vector<double>& r, const std::vector<double>& c);

}  // namespace grainvdb
