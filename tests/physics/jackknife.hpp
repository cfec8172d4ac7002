#pragma once
/// Errors of the tests' own samples: of ratios of sums over independent blocks.
#include <cmath>
#include <cstddef>
#include <vector>

namespace grainvdb::testing {

struct Measured {
  double value = 0;
  double error = 0;  ///< standard error
};

/// Σ above/Σ below, and its error by leaving out one block after the other.
inline Measured ratio_of_sums(const std::vector<double>& above, const std::vector<double>& below) {
  double a = 0, b = 0;
  for (const double v : above) a += v;
  for (const double v : below) b += v;
  const auto n = static_cast<double>(above.size());
  double squares = 0;
  for (std::size_t k = 0; k < above.size(); ++k) squares += std::pow((a - above[k]) / (b - below[k]) - a / b, 2);
  return {a / b, std::sqrt((n - 1) / n * squares)};
}

}  // namespace grainvdb::testing
