#pragma once
/// Whether a sheared layer is steady: the balance of momentum over its height, and the drift of its energy.
#include <cstddef>
#include <vector>

#include "measure/least_squares.hpp"

namespace grainvdb {

/// ∫ f dx from the first x, by the trapezoidal rule.
std::vector<double> integral(const std::vector<double>& x, const std::vector<double>& f);

/// The stresses and the density over the height z, in ascending order.
struct LayerProfile {
  std::vector<double> z;        ///< [length]
  std::vector<double> shear;    ///< σ_xz [stress]
  std::vector<double> normal;   ///< σ_zz, tension positive [stress]
  std::vector<double> density;  ///< Σ m W [mass/length³]
};

/// In steady flow under gravity g along -z the shear stress does not depend on z, and ∂σ_zz/∂z = ρ g (A21).
struct Balance {
  double shear;          ///< mean σ_xz
  double shear_change;   ///< slope of σ_xz times the height, over its mean
  double gravity;        ///< slope of σ_zz against ∫ρ dz: what g holds the layer
  double normal_change;  ///< slope of σ_zz against z times the height, over its mean: 0 without gravity
  double residual;  ///< root mean square of σ_zz - (constant + g ∫ρ dz), with the constant that makes it least, over
                    ///< the mean of |σ_zz|
};
Balance balance_of(const LayerProfile& layer, double gravity);

/// constant + g ∫ρ dz, with the constant that lies nearest to σ_zz.
std::vector<double> balanced_stress(const LayerProfile& layer, double gravity);

/// A fit of e = e₀ + r (t - mean t), whose parameters are e₀ and r; of equal, unknown errors.
Fit fit_drift(const std::vector<double>& time, const std::vector<double>& energy);

}  // namespace grainvdb
