#pragma once
/// The affine velocity field that fits particles best: v = M x + v0 by least squares.
#include <array>
#include <cstddef>

#include "grainvdb/box.hpp"

namespace grainvdb {

struct AffineVelocity {
  std::array<double, 9> gradient{};  ///< M_ij = ∂v_i/∂x_j, row by row [1/time]
  std::array<double, 9> error{};     ///< standard errors of these; NaN where there are no more than 4 particles
  Vec3 mean{};                       ///< of the velocities [length/time]
};

/// Sums over the particles of one place; their number is all that memory does not grow with.
class AffineFit {
 public:
  /// x is best measured from the place itself: sums are formed about zero.
  void add(const Vec3& x, const Vec3& v);

  std::size_t count() const { return count_; }
  /// Of the places as seen in units of `scale` along each axis, the design matrix of the fit without its constant:
  /// √(largest/smallest eigenvalue of Σ(x - x̄)(x - x̄)ᵀ). Infinite where particles leave a direction out.
  double condition(const Vec3& scale) const;
  /// The best M, with errors s_i √(S⁻¹_jj), S = Σ(x - x̄)(x - x̄)ᵀ, s_i² = Σ(residual of v_i)²/(n - 4). Meaningless
  /// where the condition number is infinite.
  AffineVelocity fit() const;

 private:
  /// S, row by row [length²].
  std::array<double, 9> places() const;

  std::size_t count_ = 0;
  Vec3 reference_{};            // the first velocity: sums of what is left of the others do not cancel
  Vec3 x_{}, v_{};              // Σx, Σ(v - reference)
  std::array<double, 9> xx_{};  // Σ x_i x_j
  std::array<double, 9> vx_{};  // Σ v_i x_j
  Vec3 vv_{};                   // Σ v_i²
};

/// The standard error of |γ̇| = √(2 D':D'), √Σ(2 D'_ij e_ij/|γ̇|)², as if those of M were independent; NaN where |γ̇| = 0.
double shear_rate_error(const AffineVelocity& velocity);

}  // namespace grainvdb
