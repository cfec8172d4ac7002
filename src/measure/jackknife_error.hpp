#pragma once
/// Standard errors by leaving out one part of the data at a time.
#include <cmath>
#include <limits>
#include <vector>

namespace grainvdb {

/// The delete-a-group jackknife: error² = (G-1)/G Σ_j (θ_j - θ̄)², θ_j the result without group j of G. It holds where
/// groups are independent: slabs thicker than what moves together, samples in time further apart than what lasts. NaN
/// for fewer than two groups or where a result is.
inline double jackknife_error(const std::vector<double>& without) {
  if (without.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto groups = static_cast<double>(without.size());
  double mean = 0, sum = 0;
  for (const double x : without) mean += x / groups;
  for (const double x : without) sum += (x - mean) * (x - mean);
  return std::sqrt((groups - 1) / groups * sum);
}

}  // namespace grainvdb
