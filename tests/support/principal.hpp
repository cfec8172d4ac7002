#pragma once
/// Principal values and axes of symmetric tensors by Jacobi rotations, with bounds for an error of the tensor.
#include <array>

#include "grainvdb/box.hpp"
#include "support/uncertain.hpp"

namespace grainvdb::testing {

using UncertainTensor = std::array<Uncertain, 9>;

struct Principal {
  Vec3 values{};               ///< descending
  std::array<Vec3, 3> axes{};  ///< axes[k] belongs to values[k]
  double error = 0;            ///< of each value: the Frobenius norm of the tensor's error (Weyl)

  double largest() const;  ///< max |value|
  /// (values[k] - values[k+1])/largest, k = 0 or 1; zero for the zero tensor.
  Uncertain relative_gap(std::size_t k) const;
  /// Bound of the angle between axis k and the true one [rad]: (π/2) ‖E‖/(gap - ‖E‖) (Davis and Kahan), the gap being
  /// that to the nearest other value; π/2 where that says nothing.
  double axis_error(std::size_t k) const;
};

/// Of the symmetric part.
Principal principal_of(const UncertainTensor& a);

/// The angle between two axes without direction, 0 … π/2.
double angle_between(const Vec3& a, const Vec3& b);

}  // namespace grainvdb::testing
