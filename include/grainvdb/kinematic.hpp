#pragma once
/// Slow drainage through a slot at the origin of the x-z plane: the kinematic model of the mean flow, and the void
/// model of which it is the mean. Pure functions of places at height z > 0 above the slot.
///
/// b [length] is everywhere that of ∂v/∂z = b ∂²v/∂x², so that profiles have the variance 2bz and what diffuses makes
/// sideways steps of variance 2bΔz. Where b = Var(Δx)/(4Δz) is quoted (1.14 d in the spot literature), it is half of
/// this one (2.28 d).
#include <cmath>
#include <numbers>

namespace grainvdb {

/// The downward velocity v that solves ∂v/∂z = b ∂²v/∂x² with v(x, 0) = Q δ(x), and the sideways velocity u = b ∂v/∂x
/// that it takes for the flow to be incompressible.
struct KinematicFlow {
  double b = 0;          ///< > 0 [length]
  double discharge = 0;  ///< Q, area per time and depth of the slot: ∫ v dx at every height [length²/time]

  /// v = Q e^(-x²/(4bz))/√(4πbz).
  double downward(double x, double z) const {
    return discharge * std::exp(-x * x / (4 * b * z)) / std::sqrt(4 * std::numbers::pi * b * z);
  }
  /// u = b ∂v/∂x = -v x/(2z): towards the middle.
  double sideways(double x, double z) const { return -downward(x, z) * x / (2 * z); }
  /// 2bz, the variance of v over x [length²].
  double variance(double z) const { return 2 * b * z; }
  /// Where the streamline through (x0, z0) is at height z: x0 √(z/z0).
  static double streamline(double x0, double z0, double z) { return x0 * std::sqrt(z / z0); }
  /// The time along it from height z0 down to z1: (2/3) √(4πb) e^(x0²/(4bz0)) (z0^(3/2) - z1^(3/2))/Q.
  double residence(double x0, double z0, double z1) const {
    return 2.0 / 3 * std::sqrt(4 * std::numbers::pi * b) * std::exp(x0 * x0 / (4 * b * z0)) *
           (z0 * std::sqrt(z0) - z1 * std::sqrt(z1)) / discharge;
  }
};

/// A grain that falls from (x0, z0) as voids take its place, their concentration that of the kinematic flow. The
/// probability P of its place at height z obeys -∂P/∂z = b ∂²P/∂x² - 2b ∂/∂x(P ∂ log v/∂x): it diffuses as fast as the
/// voids, which is what real grains do not.
struct VoidModel {
  double b = 0;  ///< > 0 [length]

  /// 2b ∂ log v/∂x = -x/z, the mean way sideways per height fallen.
  static double drift(double x, double z) { return -x / z; }
  /// b, half the variance gained per height fallen [length].
  double diffusivity() const { return b; }
  /// x0 z/z0, the mean place.
  static double mean(double x0, double z0, double z) { return x0 * z / z0; }
  /// 2bz(1 - z/z0), its variance [length²].
  double variance(double z0, double z) const { return 2 * b * z * (1 - z / z0); }
  /// P(x; z), normal with that mean and variance, 0 < z < z0 [1/length].
  double probability(double x0, double z0, double x, double z) const {
    const double s = variance(z0, z);
    const double from_mean = x - mean(x0, z0, z);
    return std::exp(-from_mean * from_mean / (2 * s)) / std::sqrt(2 * std::numbers::pi * s);
  }
};

}  // namespace grainvdb
