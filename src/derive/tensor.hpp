#pragma once
/// Invariants and principal axes of 3×3 tensors, stored row by row as the fields are (ij at 3 i + j).
#include <array>

#include "grainvdb/box.hpp"

namespace grainvdb {

using Tensor = std::array<double, 9>;

double trace(const Tensor& a);

/// ½ (a + aᵀ).
Tensor symmetric_part(const Tensor& a);

/// a':a' with the deviator a' = a - (Tr a/3) 1; the antisymmetric part of a counts.
double deviator_square(const Tensor& a);

/// |γ̇| = √(2 D':D') with D the symmetric part of the velocity gradient (A8)-(A10).
double shear_rate_of(const Tensor& velocity_gradient);

/// The largest error of a principal value of a tensor whose components were rounded to float, relative to the largest
/// magnitude among the principal values: ‖E‖₂ ≤ ‖E‖_F ≤ 2⁻²⁴ ‖σ‖_F ≤ √3 2⁻²⁴ max|σ_k|.
inline constexpr double float_tensor_rounding = 1.7320508075688772 / 16777216;

/// Eigenvalues and unit eigenvectors of a symmetric part, the largest value first.
struct PrincipalFrame {
  Vec3 values{};
  std::array<Vec3, 3> axes{};  ///< axes[k] belongs to values[k]; the first component beyond ½ in magnitude is positive

  double largest_magnitude() const;
  /// (values[k] - values[k+1]) / largest_magnitude(), k = 0 or 1; zero for the zero tensor.
  double relative_gap(std::size_t k) const;
};

/// The eigenvalues and axes of the symmetric part of `a`, whose components must be finite.
PrincipalFrame principal_frame(const Tensor& a);

/// The same without the axes.
Vec3 principal_values(const Tensor& a);

}  // namespace grainvdb
