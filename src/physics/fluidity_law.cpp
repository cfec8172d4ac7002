#include <cmath>

#include "grainvdb/laws.hpp"

namespace grainvdb {

// Beyond φ = B the sum below adds two positive terms; before it they cancel, which costs no more than rounding of
// |φ-B|/D.
double FluidityLaw::operator()(double phi) const {
  const double x = phi - b;
  return a - (x + std::sqrt(x * x + c)) / d;
}

double FluidityLaw::zero() const {
  const double k = a * d;
  return b + 0.5 * (k - c / k);
}

}  // namespace grainvdb
