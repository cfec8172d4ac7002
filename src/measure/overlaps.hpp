#pragma once
/// How much grains overlap.
#include <cstddef>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/counted_region.hpp"

namespace grainvdb {

struct Overlaps {
  std::size_t grains = 0;  ///< that count
  /// Σ_i Σ_j (δ_ij/d_ij)²/N, δ_ij = max(d_ij - |x_i - x_j|, 0), d_ij = r_i + r_j; NaN without grains. Spheres of one
  /// size at random places have 0.8 φ on average.
  double badness = 0;
  double error = 0;           ///< standard error, pairs taken as independent of each other
  double largest = 0;         ///< δ_ij/d_ij
  double largest_length = 0;  ///< δ_ij [length]
  double overlapping = 0;     ///< share of the grains that overlap another; NaN without grains
};

Overlaps overlaps(const Box& box, const Columns3& position, const std::vector<double>& radius,
                  const CountedRegion& region);

}  // namespace grainvdb
