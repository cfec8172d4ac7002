#include "measure/affine_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "derive/tensor.hpp"

namespace grainvdb {
namespace {

/// Σ a_k a_kᵀ/λ_k.
Tensor inverse(const PrincipalFrame& frame) {
  Tensor inverse{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) inverse[3 * i + j] += frame.axes[k][i] * frame.axes[k][j] / frame.values[k];
  return inverse;
}

}  // namespace

void AffineFit::add(const Vec3& x, const Vec3& v) {
  if (count_ == 0) reference_ = v;
  ++count_;
  for (std::size_t i = 0; i < 3; ++i) {
    const double dv = v[i] - reference_[i];
    x_[i] += x[i];
    v_[i] += dv;
    vv_[i] += dv * dv;
    for (std::size_t j = 0; j < 3; ++j) {
      xx_[3 * i + j] += x[i] * x[j];
      vx_[3 * i + j] += dv * x[j];
    }
  }
}

std::array<double, 9> AffineFit::places() const {
  std::array<double, 9> s{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) s[3 * i + j] = xx_[3 * i + j] - x_[i] * x_[j] / static_cast<double>(count_);
  return s;
}

double AffineFit::condition(const Vec3& scale) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (count_ < 4) return infinity;  // fewer points than four span no volume
  std::array<double, 9> s = places();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) s[3 * i + j] /= scale[i] * scale[j];
  const Vec3 eigenvalues = principal_values(s);
  const double least = eigenvalues[2];
  const double most = eigenvalues[0];
  // Below this an eigenvalue is what rounding of the sums left.
  return least > 1e-13 * most ? std::sqrt(most / least) : infinity;
}

AffineVelocity AffineFit::fit() const {
  const auto n = static_cast<double>(count_);
  const Tensor inverse_places = inverse(principal_frame(places()));
  AffineVelocity result;
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3 c{};  // Σ(v_i - mean)(x - x̄)
    for (std::size_t j = 0; j < 3; ++j) c[j] = vx_[3 * i + j] - v_[i] * x_[j] / n;
    double explained = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) result.gradient[3 * i + j] += c[k] * inverse_places[3 * k + j];
      explained += result.gradient[3 * i + j] * c[j];
    }
    const double left = std::max(0.0, vv_[i] - v_[i] * v_[i] / n - explained);
    const double noise = count_ > 4 ? left / (n - 4) : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t j = 0; j < 3; ++j) result.error[3 * i + j] = std::sqrt(noise * inverse_places[4 * j]);
    result.mean[i] = reference_[i] + v_[i] / n;
  }
  return result;
}

double shear_rate_error(const AffineVelocity& velocity) {
  const Tensor strain = symmetric_part(velocity.gradient);
  const double mean = trace(strain) / 3;
  double squares = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    const double term = 2 * (k % 4 == 0 ? strain[k] - mean : strain[k]) * velocity.error[k];
    squares += term * term;
  }
  return std::sqrt(squares) / shear_rate_of(velocity.gradient);
}

}  // namespace grainvdb
