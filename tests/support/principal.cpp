#include "support/principal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace grainvdb::testing {

double Principal::largest() const {
  return std::max({std::abs(values[0]), std::abs(values[1]), std::abs(values[2])});
}

Uncertain Principal::relative_gap(std::size_t k) const {
  const double most = largest();
  if (most == 0) return {0, error > 0 ? std::numeric_limits<double>::infinity() : 0};
  const Uncertain gap{values[k] - values[k + 1], 2 * error};
  return gap / Uncertain{most, error};
}

double Principal::axis_error(std::size_t k) const {
  double gap = std::numeric_limits<double>::infinity();
  if (k > 0) gap = std::min(gap, values[k - 1] - values[k]);
  if (k < 2) gap = std::min(gap, values[k] - values[k + 1]);
  constexpr double right = std::numbers::pi / 2;
  return gap > 2 * error ? std::min(right, right * error / (gap - error)) : right;
}

Principal principal_of(const UncertainTensor& a) {
  double s[3][3];
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double square = 0;
  double norm = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      s[i][j] = 0.5 * (a[3 * i + j].value + a[3 * j + i].value);
      square += std::pow(0.5 * (a[3 * i + j].error + a[3 * j + i].error), 2);
      norm += s[i][j] * s[i][j];
    }
  for (int sweep = 0; sweep < 60; ++sweep)
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (s[p][q] == 0) continue;
      const double theta = 0.5 * std::atan2(2 * s[p][q], s[q][q] - s[p][p]);
      const double c = std::cos(theta);
      const double t = std::sin(theta);
      for (auto& row : s) {  // s ← s R
        const double x = row[p];
        row[p] = c * x - t * row[q];
        row[q] = t * x + c * row[q];
      }
      for (int k = 0; k < 3; ++k) {  // s ← Rᵀ s
        const double x = s[p][k];
        s[p][k] = c * x - t * s[q][k];
        s[q][k] = t * x + c * s[q][k];
      }
      for (auto& row : v) {  // v ← v R
        const double x = row[p];
        row[p] = c * x - t * row[q];
        row[q] = t * x + c * row[q];
      }
    }
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return s[i][i] > s[j][j]; });
  Principal result;
  for (std::size_t k = 0; k < 3; ++k) {
    const int column = order[k];
    result.values[k] = s[column][column];
    result.axes[k] = {v[0][column], v[1][column], v[2][column]};
  }
  // The rotations themselves err by a few ulps of the norm, in the program as here.
  result.error = std::sqrt(square) + 1e-14 * std::sqrt(norm);
  return result;
}

double angle_between(const Vec3& a, const Vec3& b) {
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const Vec3 cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return std::atan2(std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]), std::abs(dot));
}

}  // namespace grainvdb::testing
