#pragma once
#include <limits>

namespace grainvdb {

/// What stands where a quantity has no value.
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace grainvdb
