#pragma once
/// The kinematic flow to an orifice (physics section 6), in the plane y = 0 and in time: downward velocity
/// v = Q e^(-x²/4bz)/√(4πbz), horizontal velocity v x/(2z) towards the middle.
#include <cmath>
#include <numbers>

#include "grainvdb/box.hpp"

namespace grainvdb::testing {

struct OrificeFlow {
  double b = 2.28, q = 1;

  Vec3 velocity(const Vec3& x) const {
    const double v = q * std::exp(-x[0] * x[0] / (4 * b * x[2])) / std::sqrt(4 * std::numbers::pi * b * x[2]);
    return {-v * x[0] / (2 * x[2]), 0, -v};
  }
  /// Where the streamline through (x0, z0) is at height z.
  static double x_at(double z, double x0, double z0) { return x0 * std::sqrt(z / z0); }
  /// The time from height z0 to z1 along it.
  double residence(double x0, double z0, double z1) const {
    return 2.0 / 3 * std::sqrt(4 * std::numbers::pi * b) * std::exp(x0 * x0 / (4 * b * z0)) *
           (std::pow(z0, 1.5) - std::pow(z1, 1.5)) / q;
  }
};

}  // namespace grainvdb::testing
