#pragma once
/// Eigenvalues of symmetric 3×3 matrices by Jacobi rotations in long double: slow, simple and independent of the
/// library.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace grainvdb::testing {

struct Eigen3 {
  std::array<double, 3> values{};                ///< descending
  std::array<std::array<double, 3>, 3> vectors;  ///< vectors[k] belongs to values[k]
};

/// Of the symmetric part of a row-major matrix.
inline Eigen3 jacobi(const std::array<double, 9>& m) {
  using Real = long double;
  std::array<std::array<Real, 3>, 3> a{};
  std::array<std::array<Real, 3>, 3> v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      a[i][j] = (static_cast<Real>(m[3 * i + j]) + static_cast<Real>(m[3 * j + i])) / 2;
  for (int sweep = 0; sweep < 30; ++sweep) {
    for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
      if (a[p][q] == 0) continue;
      const Real angle = std::atan2(2 * a[p][q], a[q][q] - a[p][p]) / 2;
      const Real c = std::cos(angle);
      const Real s = std::sin(angle);
      for (std::size_t k = 0; k < 3; ++k) {
        const Real x = a[k][p];
        const Real y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Real x = a[p][k];
        const Real y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        const Real vx = v[k][p];
        const Real vy = v[k][q];
        v[k][p] = c * vx - s * vy;
        v[k][q] = s * vx + c * vy;
      }
    }
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] > a[j][j]; });
  Eigen3 result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.values[k] = static_cast<double>(a[order[k]][order[k]]);
    for (std::size_t i = 0; i < 3; ++i) result.vectors[k][i] = static_cast<double>(v[i][order[k]]);
  }
  return result;
}

}  // namespace grainvdb::testing
