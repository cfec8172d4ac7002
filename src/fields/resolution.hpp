#pragma once
/// What fluctuations can be told from the rounding of the vectors they are fluctuations of.
#include <cmath>
#include <string>

#include "grainvdb/box.hpp"
#include "grainvdb/options.hpp"

namespace grainvdb {

/// The option `resolution` of the stage of a mean vector. Dumps print six digits where nobody asked for more, which
/// leaves 1e-6 ... 1e-5 of a number; sums in single precision are good to about 1e-6.
inline OptionInfo resolution_option(const std::string& consequence) {
  return {.name = "resolution",
          .default_value = 1e-5,
          .help = "fraction of the mean to which dumps give it (1e-5: six digits); " + consequence,
          .minimum = 0,
          .maximum = 1};
}

/// (resolution |mean|)²: squared fluctuations up to this are rounding.
inline double noise_square(double resolution, const Vec3& mean) {
  return resolution * resolution * (mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
}

}  // namespace grainvdb
