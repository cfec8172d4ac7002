#include "grainvdb/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

#include "base/vec3.hpp"

namespace grainvdb {
namespace {

// W c³ / K at (r/c)² = q2, K = 105/(16 π).
double shape(double q2) {
  const double q = std::sqrt(q2);
  if (!(q < 1)) return 0;
  const double p = 1 - q;
  return p * p * p * (1 + 3 * q);
}

// ∫₀ᵗ (1 - 6 r² + 8 r³ - 3 r⁴) dt, r² = b² + t², lengths in units of c: t - 6 I₂ + 8 I₃ - 3 I₄ of physics section 2.
double antiderivative(double b2, double t) {
  const double t2 = t * t;
  const double b4 = b2 * b2;
  const double r = std::sqrt(b2 + t2);
  const double i2 = t * (b2 + t2 / 3);
  // b⁴ asinh(t/b) → 0 as b → 0.
  const double logarithm = b4 > 0 ? 3 * b4 / 8 * std::asinh(t / std::sqrt(b2)) : 0;
  const double i3 = t * r * (2 * (b2 + t2) + 3 * b2) / 8 + logarithm;
  const double i4 = t * (b4 + t2 * (2 * b2 / 3 + t2 / 5));
  return t - 6 * i2 + 8 * i3 - 3 * i4;
}

// ∫ (1-r)³(1+3r) dt from t to t + length along a line at distance b from the centre, all of it inside the support;
// lengths in units of c. The antiderivative loses digits by the ratio of |t| and b to the length of the interval: it is
// used where the middle of the interval is nearer to the centre than twice the interval's length, so that no term is
// more than a few times the length. Beyond that distance R the singularities of r³ at t = ±ib are so far from the
// interval that the 8-point Gauss rule gives the mean to 1.1e-16 (R/c)³ (measured against 40-digit quadrature over all
// directions; 8.7e-16 at 1.75, 3.3e-18 at 2.5 times the length); the other terms are polynomials that it integrates
// exactly, and its terms are positive.
double integral_inside(double b2, double t, double length) {
  const double middle = t + 0.5 * length;
  if (b2 + middle * middle < 4 * length * length)
    return std::max(0.0, antiderivative(b2, t + length) - antiderivative(b2, t));
  double sum = 0;
  for (const LineNode& node : gauss_rule(8)) {
    const double x = middle + 0.5 * length * node.x;
    sum += node.weight * shape(b2 + x * x);
  }
  return 0.5 * length * sum;
}

}  // namespace

LucyKernel::LucyKernel(double cutoff)
    : cutoff_(cutoff), inverse_cutoff_(1 / cutoff), norm_(105 / (16 * std::numbers::pi * cutoff * cutoff * cutoff)) {
  if (!(cutoff > 0) || !std::isfinite(cutoff))
    throw std::invalid_argument("the kernel cutoff must be positive and finite");
}

double LucyKernel::gradient_factor(double r2) const {
  const double q = std::sqrt(r2) * inverse_cutoff_;
  if (!(q < 1)) return 0;
  const double p = 1 - q;
  return -12 * norm_ * inverse_cutoff_ * inverse_cutoff_ * p * p;
}

double LucyKernel::line_integral(const Vec3& p, const Vec3& a) const {
  Vec3 e{a[0] * inverse_cutoff_, a[1] * inverse_cutoff_, a[2] * inverse_cutoff_};
  const Vec3 start{p[0] * inverse_cutoff_, p[1] * inverse_cutoff_, p[2] * inverse_cutoff_};
  const double length = std::sqrt(dot(e, e));
  // Over so short a branch W changes by less than 3.72/c⁴ · 1e-17 c < 2e-17 W(0).
  if (length < 1e-17) return value(dot(p, p));
  for (double& x : e) x /= length;

  // Distance b of the line from the centre, and the signed distance of the start from the foot of the perpendicular.
  const double t = dot(start, e);
  const Vec3 foot{start[0] - t * e[0], start[1] - t * e[1], start[2] - t * e[2]};
  const double b2 = dot(foot, foot);
  if (!(b2 < 1)) return 0;
  const double rim = std::sqrt(1 - b2);
  // What lies inside, from the start of the branch: short lengths keep their digits where t + length would not.
  const double enter = std::max(0.0, -rim - t);
  const double leave = std::min(length, rim - t);
  if (!(enter < leave)) return 0;
  return norm_ * integral_inside(b2, t + enter, leave - enter) / length;
}

double LucyKernel::line_integral(const Vec3& p, const Vec3& a, std::span<const LineNode> rule) const {
  double sum = 0;
  for (const LineNode& node : rule) {
    const double s = 0.5 * (1 + node.x);
    const Vec3 x{p[0] + s * a[0], p[1] + s * a[1], p[2] + s * a[2]};
    sum += node.weight * value(dot(x, x));
  }
  return 0.5 * sum;
}

double LucyKernel::line_integral_gauss(const Vec3& p, const Vec3& a, int n) const {
  return line_integral(p, a, gauss_rule(n));
}

double LucyKernel::line_integral_adaptive(const Vec3& p, const Vec3& a) const {
  const LineDivision division = divide_branch(std::sqrt(dot(a, a)) * inverse_cutoff_);
  const double share = 1.0 / division.parts;
  const Vec3 part{share * a[0], share * a[1], share * a[2]};
  double sum = 0;
  for (int k = 0; k < division.parts; ++k)
    sum +=
        line_integral({p[0] + k * part[0], p[1] + k * part[1], p[2] + k * part[2]}, part, lucy_rule(division.points));
  return share * sum;
}

bool LucyKernel::reaches(const Vec3& p, const Vec3& a) const {
  const double aa = dot(a, a);
  const double s = aa > 0 ? std::clamp(-dot(p, a) / aa, 0.0, 1.0) : 0.0;
  const Vec3 nearest{p[0] + s * a[0], p[1] + s * a[1], p[2] + s * a[2]};
  return dot(nearest, nearest) < cutoff_ * cutoff_;
}

double LucyKernel::marginal(double z) const {
  const double zeta = std::abs(z) * inverse_cutoff_;
  if (!(zeta < 1)) return 0;
  const double p = (1 - zeta) * (1 - zeta);
  return 21.0 / 16 * inverse_cutoff_ * p * p * (1 + zeta * (4 + 5 * zeta));
}

double LucyKernel::marginal_integral(double z) const {
  const double zeta = std::abs(z) * inverse_cutoff_;
  if (!(zeta < 1)) return std::copysign(0.5, z);
  const double z2 = zeta * zeta;
  const double half = 21.0 / 16 * zeta * (1 + z2 * (-5.0 / 3 + z2 * (3 + zeta * (-8.0 / 3 + 5.0 / 7 * zeta))));
  return std::copysign(std::min(half, 0.5), z);
}

double LucyKernel::marginal_gradient(double z) const {
  const double zeta = std::abs(z) * inverse_cutoff_;
  if (!(zeta < 1)) return 0;
  const double p = 1 - zeta;
  return -105.0 / 8 * inverse_cutoff_ * inverse_cutoff_ * p * p * p * (1 + 3 * zeta) * (z * inverse_cutoff_);
}

// On either side of its centre w₁ is a polynomial of degree 6, which the 4-point Gauss rule integrates exactly: from
// terms that are all positive, where the difference of antiderivatives loses what a branch along the planes, or the rim
// of the kernel, leaves of it.
double LucyKernel::marginal_line_integral(double z, double dz) const {
  static const std::span<const LineNode> rule = gauss_rule(4);
  // ∫ ds over a part of the branch on one side of the centre, from 0 ≤ begin to end ≤ 1.
  const auto on_one_side = [&](double begin, double end) {
    const double half = 0.5 * (end - begin), middle = 0.5 * (begin + end);
    double sum = 0;
    for (const LineNode& node : rule) sum += node.weight * marginal(z + (middle + half * node.x) * dz);
    return half * sum;
  };
  const double from = std::abs(z), to = std::abs(z + dz);
  if (z * (z + dz) >= 0 && std::max(from, to) <= cutoff_) return on_one_side(0, 1);
  if (!(std::abs(dz) > 1e-17 * cutoff_)) return marginal(z);
  // Where on the branch the kernel begins, has its centre and ends.
  std::array<double, 3> at{(-cutoff_ - z) / dz, -z / dz, (cutoff_ - z) / dz};
  if (dz < 0) std::swap(at[0], at[2]);
  for (double& s : at) s = std::clamp(s, 0.0, 1.0);
  return (at[0] < at[1] ? on_one_side(at[0], at[1]) : 0) + (at[1] < at[2] ? on_one_side(at[1], at[2]) : 0);
}

double LucyKernel::radial_integral(double r) const {
  const double q = r * inverse_cutoff_;
  if (!(q < 1)) return 1;
  // 105/4 ∫ q² (1-q)³ (1+3q) dq
  return std::min(1.0, q * q * q * (35.0 / 4 + q * q * (-63.0 / 2 + q * (35 - 45.0 / 4 * q))));
}

double LucyKernel::fourier(double k) const {
  const double x = std::abs(k) * cutoff_;
  const double x2 = x * x;
  // 630 [x² sin x + x (7 cos x + 8) - 15 sin x]/x⁷ cancels as 1/x⁶. Its power series Σ (-1)^m 2520 (m+1)(m+2)
  // x^{2m}/(2m+7)! has no large terms below x = 4, where the closed form still carries a rounding error of 15·630/x⁶
  // = 2.3 units.
  if (x < 4) {
    double term = 1;
    double sum = 1;
    for (int m = 0; std::abs(term) > 1e-18; ++m) {
      term *= -x2 * (m + 3) / ((m + 1.0) * (2 * m + 8) * (2 * m + 9));
      sum += term;
    }
    return sum;
  }
  const double s = std::sin(x);
  return 630 * (s - 15 * s / x2 + (7 * std::cos(x) + 8) / x) / (x2 * x2 * x);
}

}  // namespace grainvdb
