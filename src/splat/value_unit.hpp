#pragma once
/// What single-precision values are measured in.
#include <algorithm>
#include <cmath>

namespace grainvdb {

/// For values up to `largest`: a power of two, so that a sum does not depend to the last bit on how large values are
/// elsewhere in the frame.
inline double unit_of(double largest) {
  if (!(largest > 0)) return 1;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, std::clamp(exponent, -1000, 1000));  // so that its inverse is finite
}

}  // namespace grainvdb
