#include "derive/tensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Eigenvalues>

namespace grainvdb {
namespace {

Eigen::Matrix3d symmetric_matrix(const Tensor& a) {
  const Tensor s = symmetric_part(a);
  Eigen::Matrix3d m;
  m << s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8];
  return m;
}

/// An axis has no sense of direction, so one is chosen: the first component beyond ½ in magnitude is positive. One
/// always is (1/√3 > ½), and neither axes along the coordinates nor axes at 45° between them flip with rounding.
Vec3 oriented(const Eigen::Vector3d& v) {
  double sign = 1;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (std::abs(v[i]) > 0.5) {
      sign = v[i] < 0 ? -1 : 1;
      break;
    }
  }
  return {sign * v[0], sign * v[1], sign * v[2]};
}

}  // namespace

double trace(const Tensor& a) {
  return a[0] + a[4] + a[8];
}

Tensor symmetric_part(const Tensor& a) {
  const double xy = 0.5 * (a[1] + a[3]);
  const double xz = 0.5 * (a[2] + a[6]);
  const double yz = 0.5 * (a[5] + a[7]);
  return {a[0], xy, xz, xy, a[4], yz, xz, yz, a[8]};
}

double deviator_square(const Tensor& a) {
  const double mean = trace(a) / 3;
  double sum = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    const double d = k % 4 == 0 ? a[k] - mean : a[k];
    sum += d * d;
  }
  return sum;
}

double shear_rate_of(const Tensor& velocity_gradient) {
  return std::sqrt(2 * deviator_square(symmetric_part(velocity_gradient)));
}

double PrincipalFrame::largest_magnitude() const {
  return std::max(std::abs(values[0]), std::abs(values[2]));
}

double PrincipalFrame::relative_gap(std::size_t k) const {
  const double scale = largest_magnitude();
  return scale > 0 ? (values[k] - values[k + 1]) / scale : 0;
}

// The iterative solver keeps errors at the rounding of double. Eigen's closed form (computeDirect) is off by up to 1e-8
// of the norm, which near equal principal values is not small against the gap that decides whether axes exist.
PrincipalFrame principal_frame(const Tensor& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric_matrix(a));
  const Eigen::Matrix3d& vectors = solver.eigenvectors();
  PrincipalFrame frame;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto column = static_cast<Eigen::Index>(2 - k);  // Eigen sorts ascending
    frame.values[k] = solver.eigenvalues()[column];
    frame.axes[k] = oriented(vectors.col(column));
  }
  return frame;
}

Vec3 principal_values(const Tensor& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric_matrix(a), Eigen::EigenvaluesOnly);
  return {solver.eigenvalues()[2], solver.eigenvalues()[1], solver.eigenvalues()[0]};
}

}  // namespace grainvdb
