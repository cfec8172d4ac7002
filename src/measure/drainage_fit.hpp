#pragma once
/// The kinematic model fitted to a measured flow towards a slot. b is that of ∂v/∂z = b ∂²v/∂x².
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "measure/estimate.hpp"
#include "measure/least_squares.hpp"

namespace grainvdb {

/// The velocity at the distance x from the middle and the height z above the slot.
struct DrainagePoint {
  double x = 0;            ///< [length]
  double z = 0;            ///< [length]
  double v = 0;            ///< downward [length/time]
  double independent = 1;  ///< the part of it that no other point tells, in (0, 1]
  double u = 0;            ///< along x [length/time]
};

/// Where profiles have no width.
enum class Origin {
  slot,    ///< at z = 0, a slot without width
  fitted,  ///< at z = -rise: the slot is wide, and the kernel widens profiles too
};

struct KinematicEstimate {
  std::string refusal;  ///< why there is no fit, in a sentence; empty where there is one
  Estimate b;           ///< [length]
  Estimate discharge;   ///< Q [length²/time]
  Estimate rise;        ///< 0 for Origin::slot [length]
  double rms = std::numeric_limits<double>::quiet_NaN();  ///< of the residuals of v [length/time]
};

/// v = Q e^(-x²/(4b(z + rise)))/√(4πb(z + rise)) by least squares over all points, all of which count alike. Errors are
/// those of the residuals, for as many values as are independent.
KinematicEstimate fit_kinematic(std::span<const DrainagePoint> points, Origin origin);

/// The profile at one height.
struct DrainageProfile {
  double z = 0;       ///< [length]
  Estimate variance;  ///< s² of the best A e^(-(x-m)²/(2s²)) [length²]
  Estimate middle;    ///< its m [length]
  Estimate peak;      ///< its A [length/time]
  double moment_variance =
      std::numeric_limits<double>::quiet_NaN();  ///< Σv x²/Σv about Σv x/Σv, walls and all [length²]
};

/// One profile for each height, in ascending order; without variance where a Gaussian cannot be fitted.
std::vector<DrainageProfile> fit_profiles(std::span<const DrainagePoint> points);

struct WidthGrowth {
  std::string refusal;  ///< why there is none, in a sentence; empty where there is one
  Estimate b;           ///< half the slope [length]
  Estimate offset;      ///< variance at z = 0 [length²]
  double reduced_chi_square = std::numeric_limits<double>::quiet_NaN();  ///< near 1 where a straight line describes it
};

/// variance = 2bz + offset by linear regression over the profiles that have one, weighted by their errors. Where these
/// leave χ² above 1 by degree of freedom, the errors of b and the offset are larger by its root.
WidthGrowth fit_width(std::span<const DrainageProfile> profiles);

}  // namespace grainvdb
