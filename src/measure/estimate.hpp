#pragma once
/// A number that was estimated, with its error.
#include <limits>

namespace grainvdb {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();  ///< standard error
};

}  // namespace grainvdb
