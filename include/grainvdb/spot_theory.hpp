#pragma once
/// What a cloud of independent spots does to the grains that it passes: the mean-field drift and diffusivity of the
/// spot model. Pure functions.
#include <array>
#include <functional>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// α = V_s/(N V_p): the part of a spot's step that each of the N grains under its influence makes the other way.
constexpr double spot_influence(double spot_volume, double grain_volume, double grains) {
  return spot_volume / (grains * grain_volume);
}

/// b_p = α b: what grains spread by per height fallen, against b of the spots and in the same convention [length].
constexpr double grain_diffusion(double influence, double b) {
  return influence * b;
}

/// Spots that move on their own: their number per volume, and the same velocity and diagonal diffusivity for all.
struct SpotCloud {
  std::function<double(const Vec3&)> density;  ///< ρ_s [1/length³]
  std::function<Vec3(const Vec3&)> gradient;   ///< ∇ρ_s [1/length⁴]
  Vec3 velocity{};                             ///< u_s [length/time]
  Vec3 diffusivity{};                          ///< D_s [length²/time]
};

/// The grains within `radius` of a spot move by -influence times its step.
struct SpotReach {
  double radius = 0;     ///< R > 0 [length]
  double influence = 0;  ///< α [1]
  /// Where along its step a spot is when it is asked which grains it moves: 0 at the beginning, ½ halfway, 1 at the
  /// end.
  double place = 1;
};

struct MeanField {
  Vec3 drift{};        ///< u_p [length/time]
  Vec3 diffusivity{};  ///< D_p, diagonal [length²/time]
};

/// The drift and diffusivity of a grain at r:
///     u_p = -∫ w [ρ_s u_s - 2 s D_s·∇ρ_s] dV,  D_p = ∫ w² ρ_s D_s dV,  w = α within R of r, else 0,
/// with s = reach.place. Where w is taken at the end of a step, s = 1, this is the published form; there ⟨w(r_s + s dR)
/// dR⟩ = (w u_s + 2 s D_s·∇w) dt, of which the second part is brought over to ρ_s. With s = ½ a cloud of uniform u_s
/// makes the velocity b ∂v/∂x of the kinematic model. The integral over the ball is exact where ρ_s is a polynomial of
/// degree up to 11.
MeanField mean_field(const SpotCloud& cloud, const SpotReach& reach, const Vec3& r);

}  // namespace grainvdb
