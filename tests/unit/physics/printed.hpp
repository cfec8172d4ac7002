#pragma once
#include <cmath>

/// Half a unit in the last of `decimals` printed digits, with room for the rounding of the literal itself.
inline double half_a_digit(int decimals) {
  return 0.5 * std::pow(10.0, -decimals) * (1 + 1e-9);
}
