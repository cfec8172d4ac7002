#pragma once
/// The Lucy kernel (physics eq. 9): W(r) = 105/(16 π c³) (1-q)³ (1+3q), q = r/c < 1, else 0; ∫ W dV = 1.
#include <cmath>
#include <span>

#include "grainvdb/box.hpp"
#include "grainvdb/line_rule.hpp"

namespace grainvdb {

class LucyKernel {
 public:
  /// `cutoff` c > 0 is the radius of the support [length]. Throws std::invalid_argument otherwise.
  explicit LucyKernel(double cutoff);

  double cutoff() const { return cutoff_; }

  /// W at distance² r2 [1/length³]. Evaluated in the factored form, which is never positive outside the support.
  double value(double r2) const {
    const double r = std::sqrt(r2) * inverse_cutoff_;
    if (!(r < 1)) return 0;
    const double p = 1 - r;
    return norm_ * p * p * p * (1 + 3 * r);
  }

  /// The factor f with ∇W = f r⃗ at distance² r2: f = -(1260/(16 π c⁵)) (1-q)² [1/length⁵].
  double gradient_factor(double r2) const;

  /// ∫₀¹ W(|p + s a|) ds, the mean of W along the straight branch from p to p + a, in closed form
  /// (physics section 2), accurate to rounding for short branches and branches through the origin too [1/length³].
  double line_integral(const Vec3& p, const Vec3& a) const;

  /// The same by a quadrature rule.
  double line_integral(const Vec3& p, const Vec3& a, std::span<const LineNode> rule) const;

  /// The same by W and its second derivative along the branch at the middle m: W(m) + (a·∇)²W(m)/24 (Taylor's series
  /// of W, of whose terms the even ones are left: ∫ (s-½)² ds = 1/12). With d = m/c, e = a/c, q = |d| that is
  /// W(0) [(1-q)³(1+3q) - ½ (1-q)² e² + (1-q)(e·d)²/q]. The error is less than |e|³/4 W(0), that of 8 q³ on a branch
  /// which the centre bisects; near the rim the value can be as little as -|e|⁶/864 W(0).
  double line_integral_midpoint_curvature(const Vec3& p, const Vec3& a) const;

  /// The same by as few points as keep the error within lucy_rule_error W(0).
  double line_integral_adaptive(const Vec3& p, const Vec3& a) const;

  /// Whether a point of the branch from p to p + a lies within the support: where its line integral is positive.
  bool reaches(const Vec3& p, const Vec3& a) const;

  /// The same by an n-point Gauss-Legendre rule, 1 ≤ n ≤ 8.
  double line_integral_gauss(const Vec3& p, const Vec3& a, int n) const;

  /// One-dimensional marginal ∫∫ W dx dy at distance z [1/length], and its integral from 0 to z [1].
  double marginal(double z) const;
  double marginal_integral(double z) const;

  /// dw₁/dz of the marginal [1/length²].
  double marginal_gradient(double z) const;

  /// ∫₀¹ w₁(z + s dz) ds, the mean of the marginal along a branch from z to z + dz, accurate to rounding however short
  /// the branch and faint the kernel is there [1/length].
  double marginal_line_integral(double z, double dz) const;

  /// ∫ W dV over the ball of radius r ≥ 0 about the centre [1].
  double radial_integral(double r) const;

  /// Fourier transform Ŵ(k), k = |wave vector| [1/length]; Ŵ(0) = 1.
  double fourier(double k) const;

 private:
  double cutoff_;
  double inverse_cutoff_;
  double norm_;  // 105/(16 π c³)
};

/// max |h³ Σ W - 1| over all places of a grain between the voxel centres, for a cutoff of so many voxels h: the
/// relative error of its volume in a field. Not smaller than 2.4e-5, its value at six voxels.
double grain_volume_error(double cutoff_in_voxels);

}  // namespace grainvdb
