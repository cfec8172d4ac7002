#include "grainvdb/kernel.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace grainvdb {

LucyKernel::LucyKernel(double cutoff)
    : cutoff_(cutoff), inverse_cutoff_(1 / cutoff), norm_(105 / (16 * std::numbers::pi * cutoff * cutoff * cutoff)) {
  if (!(cutoff > 0) || !std::isfinite(cutoff))
    throw std::invalid_argument("the kernel cutoff must be positive and finite");
}

double LucyKernel::value(double r2) const {
  const double q = std::sqrt(r2) * inverse_cutoff_;
  if (!(q < 1)) return 0;
  const double p = 1 - q;
  return norm_ * p * p * p * (1 + 3 * q);
}

}  // namespace grainvdb
