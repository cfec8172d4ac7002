// The marginal of the kernel along branches, and its derivative.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "unit/base/quadrature.hpp"

namespace grainvdb::marginal_branch_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// w₁ c at ζ, in long double.
long double marginal(long double zeta) {
  zeta = std::abs(zeta);
  if (zeta >= 1) return 0;
  const long double p = (1 - zeta) * (1 - zeta);
  return 21.0L / 16 * p * p * (1 + 4 * zeta + 5 * zeta * zeta);
}

/// The mean of w₁ c from ζ to ζ + d, a polynomial between -1, 0 and 1: over the part of the branch between these, so
/// that short branches keep their length.
long double mean(long double zeta, long double d) {
  if (d == 0) return marginal(zeta);
  std::array<long double, 3> at{(-1 - zeta) / d, -zeta / d, (1 - zeta) / d};
  std::sort(at.begin(), at.end());
  long double sum = 0;
  for (std::size_t n = 0; n < 2; ++n) {
    const long double a = std::clamp(at[n], 0.0L, 1.0L), b = std::clamp(at[n + 1], 0.0L, 1.0L);
    if (a < b) sum += quadrature::integrate([&](long double s) { return marginal(zeta + s * d); }, a, b, 1);
  }
  return sum;
}

// Relative to the value at the nearest end: rounding of a place by ε moves w₁ by a part 4ε/(1-ζ), which is all that
// may be lost, on the rim and for branches that hardly leave a plane too.
TEST(MarginalLineIntegral, KeepsItsDigitsForBranchesOfAllLengthsEverywhere) {
  for (const double c : {1.0, 2.4e-3, 17.5})
    for (const double zeta : {-1.3, -1.0, -0.999, -0.6, -1e-3, 0.0, 1e-9, 0.2, 0.77, 0.9999, 1.0, 1.02})
      for (const double d : {0.0, 1e-19, 1e-16, 1e-13, 1e-9, 1e-5, 1e-3, 0.04, 0.3, 1.1, 2.5})
        for (const double sign : {-1.0, 1.0}) {
          const double expected = static_cast<double>(mean(zeta, sign * d));
          const double nearest = zeta * (zeta + sign * d) < 0 ? 0 : std::min(std::abs(zeta), std::abs(zeta + sign * d));
          const double steep = nearest < 1 ? 8 * epsilon / (1 - nearest) : 0;
          // What lies within a rounding of the rim is less than w₁(0) (10 ε)⁴.
          const double tolerance = (16 * epsilon + steep) * expected + 1e-40;
          EXPECT_NEAR(LucyKernel(c).marginal_line_integral(zeta * c, sign * d * c) * c, expected, tolerance)
              << c << ' ' << zeta << ' ' << sign * d;
        }
}

TEST(MarginalLineIntegral, IsNothingOutside) {
  const LucyKernel kernel(2);
  EXPECT_EQ(kernel.marginal_line_integral(2.1, 3), 0);
  EXPECT_EQ(kernel.marginal_line_integral(-2.1, -1e-9), 0);
  EXPECT_GT(kernel.marginal_line_integral(2.1, -3), 0);
}

// ∫∫∫₀¹ W(x + s a) ds dx dy: of the whole kernel's line integral over the plane, by the midpoint rule over 60² points a
// cutoff (a smooth function of compact support: 1e-6 is measured).
TEST(MarginalLineIntegral, IsThatOfTheKernelOverThePlane) {
  const LucyKernel kernel(1.5);
  const double step = 1.5 / 60;
  for (const Vec3& a : {Vec3{0.5, -0.3, 0.4}, Vec3{0.6, 0.1, 0}, Vec3{0, 0, -0.7}, Vec3{-0.2, 0.2, 1e-6}})
    for (const double z : {-1.1, -0.2, 0.0, 0.3, 0.9}) {
      double sum = 0;
      for (int i = -90; i < 90; ++i)
        for (int j = -90; j < 90; ++j)
          sum += step * step * kernel.line_integral({(i + 0.37) * step, (j + 0.21) * step, z}, a);
      EXPECT_NEAR(sum, kernel.marginal_line_integral(z, a[2]), 1e-6 * kernel.marginal(0)) << z << ' ' << a[2];
    }
}

TEST(MarginalGradient, IsTheDerivativeOfTheMarginal) {
  for (const double c : {1.0, 2.4e-3, 17.5}) {
    const LucyKernel kernel(c);
    for (const double zeta : {-0.9, -0.31, 0.0, 0.05, 0.5, 0.93}) {
      const long double d = 1e-6L;
      const auto slope = static_cast<double>((marginal(zeta + d) - marginal(zeta - d)) / (2 * d));
      EXPECT_NEAR(kernel.marginal_gradient(zeta * c) * c * c, slope, 1e-9) << c << ' ' << zeta;
      EXPECT_EQ(kernel.marginal_gradient(-zeta * c), -kernel.marginal_gradient(zeta * c));
    }
    EXPECT_EQ(kernel.marginal_gradient(c), 0);
    EXPECT_EQ(kernel.marginal_gradient(-1.5 * c), 0);
  }
}

}  // namespace
}  // namespace grainvdb::marginal_branch_test
