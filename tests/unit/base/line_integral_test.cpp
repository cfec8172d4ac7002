#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "unit/base/quadrature.hpp"

namespace grainvdb::line_integral_test {
namespace {

using Real = long double;

Real dot(const Vec3& a, const Vec3& b) {
  Real sum = 0;
  for (int k = 0; k < 3; ++k) sum += Real{a[k]} * b[k];
  return sum;
}

// ∫₀¹ W(|p + s a|) ds in units of W(0), by quadrature in long double, on the part of the branch inside the support.
Real reference(double cutoff, const Vec3& p, const Vec3& a) {
  const Real c = cutoff;
  const Real aa = dot(a, a), pa = dot(p, a), pp = dot(p, p);
  const auto shape = [&](Real s) {
    // r² = |p + s a|², summed from the components
    Real r2 = 0;
    for (int k = 0; k < 3; ++k) r2 += (p[k] + s * a[k]) * (p[k] + s * a[k]);
    const Real q = std::sqrt(r2) / c;
    return q < 1 ? (1 - q) * (1 - q) * (1 - q) * (1 + 3 * q) : Real{0};
  };
  if (aa == 0) return shape(0);
  const Real foot = -pa / aa;  // where the line is nearest to the centre
  Real b2 = 0;
  for (int k = 0; k < 3; ++k) b2 += (p[k] + foot * a[k]) * (p[k] + foot * a[k]);
  if (b2 >= c * c || pp != pp) return 0;
  const Real rim = std::sqrt((c * c - b2) / aa);
  const Real lo = std::max(Real{0}, foot - rim), hi = std::min(Real{1}, foot + rim);
  if (lo >= hi) return 0;
  return quadrature::integrate_about_zero([&](Real t) { return shape(foot + t); }, lo - foot, hi - foot);
}

double peak(double c) {
  return 105 / (16 * std::numbers::pi * c * c * c);
}

double error(const LucyKernel& kernel, const Vec3& p, const Vec3& a) {
  const double value = kernel.line_integral(p, a);
  EXPECT_GE(value, 0);
  return static_cast<double>(std::abs(value / peak(kernel.cutoff()) - reference(kernel.cutoff(), p, a)));
}

// The closed form is used where its terms are below a few lengths of the interval, and the 8-point rule elsewhere: both
// are worth some ten units of rounding.
constexpr double tolerance = 1e-14;

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vec3 e{normal(random), normal(random), normal(random)};
  const double length = std::sqrt(static_cast<double>(dot(e, e)));
  for (double& x : e) x /= length;
  return e;
}

TEST(LineIntegral, EqualsQuadratureOnRandomBranchesOfAllLengths) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  double worst = 0;
  for (double c : {1.0, 2.4e-3, 30.0}) {
    const LucyKernel kernel(c);
    for (int k = 0; k < 4000; ++k) {
      const double distance = 1.2 * c * std::cbrt(uniform(random));
      const double length = c * std::pow(10.0, -8 + 9 * uniform(random));
      Vec3 p = random_direction(random), a = random_direction(random);
      for (double& x : p) x *= distance;
      for (double& x : a) x *= length;
      worst = std::max(worst, error(kernel, p, a));
    }
  }
  EXPECT_LT(worst, tolerance);
}

TEST(LineIntegral, EqualsQuadratureOnEitherSideOfTheSwitchOfMethod) {
  // The middle of the branch at the switching distance, twice the length, at every angle.
  const LucyKernel kernel(1);
  for (double length : {0.01, 0.1, 0.3, 0.45})
    for (int degrees = 0; degrees <= 90; degrees += 5)
      for (double factor : {0.999, 1.001}) {
        const double angle = degrees * std::numbers::pi / 180;
        const double x = 2 * factor * length * std::cos(angle), y = 2 * factor * length * std::sin(angle);
        EXPECT_LT(error(kernel, {x - length / 2, y, 0}, {length, 0, 0}), tolerance) << length << ' ' << degrees;
      }
}

TEST(LineIntegral, BranchThroughTheCentre) {
  const LucyKernel kernel(2);
  EXPECT_LT(error(kernel, {-0.3, 0, 0}, {0.9, 0, 0}), tolerance);
  EXPECT_LT(error(kernel, {0, 0, 0}, {0, 0.5, 0.5}), tolerance);
  EXPECT_LT(error(kernel, {1, -1, 0.5}, {-2, 2, -1}), tolerance);
  // A diameter: (1/2c) 2 ∫₀ᶜ W dr = W(0) (1 - 2 + 2 - 3/5)
  EXPECT_NEAR(kernel.line_integral({-2, 0, 0}, {4, 0, 0}) / peak(2), 0.4, tolerance);
}

TEST(LineIntegral, BranchThatNearlyPassesThroughTheCentre) {
  const LucyKernel kernel(1);
  for (double b : {1e-300, 1e-160, 1e-80, 1e-20, 1e-12, 1e-8, 1e-4, 1e-2, 0.1})
    for (double length : {1e-6, 1e-3, 0.2, 1.0, 3.0})
      for (double offset : {-0.5, -0.1, 0.0, 0.7}) {
        const Vec3 p{offset * length, b, 0}, a{length, 0, 0};
        EXPECT_LT(error(kernel, p, a), tolerance) << b << ' ' << length << ' ' << offset;
      }
}

TEST(LineIntegral, BranchAlongARadius) {
  const LucyKernel kernel(1);
  for (double from : {0.0, 0.2, 0.9, 0.999, 1.0, 1.5})
    for (double to : {0.0, 0.1, 0.95, 1.0, 1.2})
      EXPECT_LT(error(kernel, {0, from, 0}, {0, to - from, 0}), tolerance) << from << ' ' << to;
}

TEST(LineIntegral, VanishingBranchGivesTheValueAtItsStart) {
  const LucyKernel kernel(3);
  const Vec3 p{0.4, -1, 0.7};
  const double r2 = 0.16 + 1 + 0.49;
  EXPECT_DOUBLE_EQ(kernel.line_integral(p, {0, 0, 0}), kernel.value(r2));
  for (double length : {1e-310, 1e-200, 1e-100, 1e-30, 1e-17, 1e-16})
    EXPECT_NEAR(kernel.line_integral(p, {length, -length, 0}), kernel.value(r2), 1e-15 * peak(3)) << length;
  EXPECT_EQ(kernel.line_integral({0, 0, 3}, {0, 0, 0}), 0);
}

TEST(LineIntegral, BranchLongerThanTheSupport) {
  const LucyKernel kernel(1);
  for (double length : {2.0, 2.1, 10.0, 1e3, 1e8}) {
    EXPECT_LT(error(kernel, {-length / 2, 0.3, 0.1}, {length, 0, 0}), tolerance);
    // Half of it inside: the mean is half the radius' share.
    EXPECT_NEAR(kernel.line_integral({0, 0, 0}, {length, 0, 0}) * length / peak(1), 0.4, tolerance * length);
  }
}

TEST(LineIntegral, IsExactlyZeroWhenTheBranchMissesTheSupport) {
  const LucyKernel kernel(1);
  EXPECT_EQ(kernel.line_integral({1.001, 0, -1}, {0, 0, 2}), 0);     // passes beside it
  EXPECT_EQ(kernel.line_integral({1, 0, -1}, {0, 0, 2}), 0);         // touches it
  EXPECT_EQ(kernel.line_integral({0, 0, 1.0001}, {0, 0, 5}), 0);     // leads away
  EXPECT_EQ(kernel.line_integral({0, 0, -5}, {0, 0, 3.9999}), 0);    // ends before
  EXPECT_EQ(kernel.line_integral({0.8, 0, 0.7}, {0.1, 0, 0.1}), 0);  // a short one outside
}

TEST(LineIntegral, IsPositiveWhenTheBranchCutsTheRim) {
  const LucyKernel kernel(1);
  for (double depth : {1e-14, 1e-10, 1e-5, 1e-2}) {
    EXPECT_GT(kernel.line_integral({1 - depth, 0, -1}, {0, 0, 2}), 0) << depth;
    EXPECT_GT(kernel.line_integral({1 - depth, 0, 0}, {1, 0, 0}), 0) << depth;
    EXPECT_LT(error(kernel, {1 - depth, 0, -1}, {0, 0, 2}), tolerance);
  }
}

TEST(LineIntegral, DoesNotDependOnTheDirectionOfTheBranch) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const LucyKernel kernel(1);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p{uniform(random), uniform(random), uniform(random)};
    const Vec3 a{uniform(random), uniform(random), uniform(random)};
    const Vec3 end{p[0] + a[0], p[1] + a[1], p[2] + a[2]};
    EXPECT_NEAR(kernel.line_integral(p, a), kernel.line_integral(end, {-a[0], -a[1], -a[2]}), tolerance * peak(1));
  }
}

// The integral over space is 1 whatever the branch: the mean over a fine lattice of positions.
TEST(LineIntegral, IsOneInTheMeanOverSpace) {
  const LucyKernel kernel(1);
  const Vec3 a{0.2, -0.3, 0.4};
  const double h = 1.0 / 12;
  double sum = 0;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j)
      for (int k = -20; k <= 20; ++k) sum += kernel.line_integral({i * h, j * h, k * h}, a);
  // h³ΣW is 1 to 2.4e-5 at c/h = 6 in the worst offset, and Ŵ ~ 1/k⁵ falls by 2⁵ towards c/h = 12.
  EXPECT_NEAR(sum * h * h * h, 1, 2.4e-5 / 32);
}

TEST(GaussRule, IntegratesPolynomialsOfItsDegree) {
  // Along a radius the kernel is a polynomial of degree 4 in s: exact from 3 points on, to rounding.
  const LucyKernel kernel(1);
  const Vec3 p{0.1, 0, 0}, a{0.6, 0, 0};
  const auto exact = static_cast<double>(reference(1, p, a));
  for (int n = 3; n <= 8; ++n) EXPECT_NEAR(kernel.line_integral_gauss(p, a, n) / peak(1), exact, 2e-15) << n;
  EXPECT_GT(std::abs(kernel.line_integral_gauss(p, a, 2) / peak(1) - exact), 1e-4);
}

TEST(GaussRule, OnePointIsTheMiddle) {
  const LucyKernel kernel(1);
  EXPECT_DOUBLE_EQ(kernel.line_integral_gauss({0.2, 0.1, 0}, {0.4, 0, 0.2}, 1), kernel.value(0.16 + 0.01 + 0.01));
}

TEST(GaussRule, ConvergesToTheClosedForm) {
  // Largest error of half branches of length c/6 in units of W(0). It belongs to the branch that the centre bisects,
  // where r³ = |t|³: for 3 points 8/12³ |1/4 - (5/9) 0.6^{3/2}| = 3.796e-5. The bounds are those of 2e6 random
  // branches.
  const double bound[] = {1.28e-2, 2.54e-4, 3.80e-5, 1.04e-5, 4.77e-6, 2.08e-6, 1.29e-6, 7.1e-7};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  const LucyKernel kernel(1);
  double worst[8] = {};
  for (int k = 0; k < 200000; ++k) {
    const double distance = 1.2 * uniform(random);
    Vec3 p = random_direction(random), a = random_direction(random);
    for (double& x : p) x *= distance;
    for (double& x : a) x /= 6;
    const double exact = kernel.line_integral(p, a);
    for (int n = 1; n <= 8; ++n)
      worst[n - 1] = std::max(worst[n - 1], std::abs(kernel.line_integral_gauss(p, a, n) - exact) / peak(1));
  }
  for (int n = 1; n <= 8; ++n) {
    EXPECT_LT(worst[n - 1], bound[n - 1]) << n;
    EXPECT_GT(worst[n - 1], 0.5 * bound[n - 1]) << n;
  }
}

TEST(GaussRule, RefusesOtherNumbersOfPoints) {
  const LucyKernel kernel(1);
  for (int n : {-1, 0, 9}) EXPECT_THROW(kernel.line_integral_gauss({0, 0, 0}, {1, 0, 0}, n), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::line_integral_test
