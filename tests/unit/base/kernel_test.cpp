#include "grainvdb/kernel.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "unit/base/quadrature.hpp"

namespace grainvdb::kernel_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

// ∫ f(r) 4π r² dr over the support; polynomials to degree 23 are integrated exactly.
template <class F>
double radial_integral(const LucyKernel& kernel, F&& f) {
  const long double c = kernel.cutoff();
  return static_cast<double>(quadrature::integrate(
      [&](long double r) { return 4 * std::numbers::pi_v<long double> * r * r * f(static_cast<double>(r)); }, 0, c, 1));
}

class Kernel : public testing::TestWithParam<double> {
 protected:
  LucyKernel kernel{GetParam()};
  double c = GetParam();
};

TEST_P(Kernel, IsOneInTheMean) {
  const double norm = radial_integral(kernel, [&](double r) { return kernel.value(r * r); });
  EXPECT_NEAR(norm, 1, 8 * epsilon);
}

TEST_P(Kernel, HasSecondMomentOfAQuarterCutoffSquared) {
  const double moment = radial_integral(kernel, [&](double r) { return r * r * kernel.value(r * r); });
  EXPECT_NEAR(moment, c * c / 4, 8 * epsilon * c * c);
}

TEST_P(Kernel, HasTheSquareIntegralOfTheReference) {
  const double square = radial_integral(kernel, [&](double r) { return kernel.value(r * r) * kernel.value(r * r); });
  const double expected = 455 / (176 * pi * c * c * c);
  EXPECT_NEAR(square, expected, 16 * epsilon * expected);
}

TEST_P(Kernel, HasItsPeakAtTheCentre) {
  EXPECT_NEAR(kernel.value(0) * c * c * c, 105 / (16 * pi), 4 * epsilon);
}

TEST_P(Kernel, IsExactlyZeroOutsideAndPositiveInside) {
  EXPECT_EQ(kernel.value(c * c * (1 + 4 * epsilon)), 0);
  EXPECT_EQ(kernel.value(4 * c * c), 0);
  EXPECT_EQ(kernel.gradient_factor(c * c * (1 + 4 * epsilon)), 0);
  EXPECT_GT(kernel.value(c * c * (1 - 8 * epsilon)), 0);
  for (int k = 0; k < 1000; ++k) EXPECT_GT(kernel.value(c * c * k / 1000), 0);
}

TEST_P(Kernel, GradientPeaksAtAThirdOfTheCutoff) {
  double peak = 0, where = 0;
  for (int k = 1; k < 3000; ++k) {
    const double r = c * k / 3000;
    const double slope = -kernel.gradient_factor(r * r) * r;
    if (slope > peak) peak = slope, where = r;
  }
  EXPECT_NEAR(where / c, 1.0 / 3, 1e-12);
  EXPECT_NEAR(peak * c * c * c * c, 3.7136, 5e-5);  // as printed, four digits
}

TEST_P(Kernel, GradientIsTheDerivativeOfTheValue) {
  const double step = 1e-5 * c;
  for (double q : {0.05, 0.3, 0.6, 0.9, 0.99}) {
    const double r = q * c;
    const double difference =
        (kernel.value((r + step) * (r + step)) - kernel.value((r - step) * (r - step))) / (2 * step);
    // The central difference errs by W''' step²/6 ≤ 1e3/c⁶ · 1e-10 c²/6, and by rounding ε W₀/step = 5e-11/c⁴.
    EXPECT_NEAR(kernel.gradient_factor(r * r) * r, difference, 2e-8 / (c * c * c * c));
  }
}

TEST_P(Kernel, RadialIntegralIsTheIntegralOverBalls) {
  for (double q : {0.0, 1e-5, 0.2, 0.5, 0.9, 1.0}) {
    const double r = q * c;
    const auto ball = quadrature::integrate(
        [&](long double x) {
          return 4 * std::numbers::pi_v<long double> * x * x * kernel.value(static_cast<double>(x * x));
        },
        0, static_cast<long double>(r), 1);
    EXPECT_NEAR(kernel.radial_integral(r), static_cast<double>(ball), 8 * epsilon) << q;
  }
  EXPECT_EQ(kernel.radial_integral(c), 1);
  EXPECT_EQ(kernel.radial_integral(3 * c), 1);
}

TEST_P(Kernel, MarginalIsTheIntegralOverPlanes) {
  for (double zeta : {0.0, 0.1, 0.35, 0.7, 0.95, 0.999}) {
    const double z = zeta * c;
    // ∫∫ W dx dy = ∫ W 2π r dr from |z| to c, a polynomial.
    const auto plane = quadrature::integrate(
        [&](long double r) {
          return 2 * std::numbers::pi_v<long double> * r * kernel.value(static_cast<double>(r * r));
        },
        static_cast<long double>(z), static_cast<long double>(c), 1);
    EXPECT_NEAR(kernel.marginal(z) * c, static_cast<double>(plane) * c, 8 * epsilon) << zeta;
    EXPECT_EQ(kernel.marginal(-z), kernel.marginal(z));
  }
  EXPECT_EQ(kernel.marginal(c), 0);
  EXPECT_EQ(kernel.marginal(-2 * c), 0);
}

TEST_P(Kernel, MarginalIntegralIsTheIntegralOfTheMarginal) {
  for (double zeta : {0.0, 1e-8, 0.1, 0.25, 0.5, 0.75, 0.99, 1.0}) {
    const double z = zeta * c;
    const auto sum = quadrature::integrate(
        [&](long double x) { return static_cast<long double>(kernel.marginal(static_cast<double>(x))); }, 0,
        static_cast<long double>(z), 1);
    EXPECT_NEAR(kernel.marginal_integral(z), static_cast<double>(sum), 4 * epsilon) << zeta;
    EXPECT_EQ(kernel.marginal_integral(-z), -kernel.marginal_integral(z));
  }
  EXPECT_EQ(kernel.marginal_integral(c), 0.5);
  EXPECT_EQ(kernel.marginal_integral(5 * c), 0.5);
  EXPECT_EQ(kernel.marginal_integral(-5 * c), -0.5);
}

TEST_P(Kernel, WallCutsTheTabulatedFractions) {
  const double inside[][2] = {{0, .5}, {.1, .629}, {.25, .797}, {.5, .9585}, {.75, .9981}};
  for (const auto& [distance, fraction] : inside)
    EXPECT_NEAR(0.5 + kernel.marginal_integral(distance * c), fraction, 1e-3);  // as printed
}

TEST_P(Kernel, FourierTransformIsTheRadialIntegral) {
  for (double x : {0.01, 0.5, 2.0, 3.9, 3.999999, 4.0, 4.000001, 5.0, 10.0, 40.0}) {
    const long double k = static_cast<long double>(x) / c;
    // Ŵ(k) = ∫ W sin(kr)/(kr) 4π r² dr
    const auto transform = quadrature::integrate(
        [&](long double r) {
          return 4 * std::numbers::pi_v<long double> * r * std::sin(k * r) / k *
                 kernel.value(static_cast<double>(r * r));
        },
        0, static_cast<long double>(c), 16);
    EXPECT_NEAR(kernel.fourier(x / c), static_cast<double>(transform), 8 * epsilon) << x;
    EXPECT_EQ(kernel.fourier(-x / c), kernel.fourier(x / c));
  }
}

TEST_P(Kernel, FourierTransformIsAccurateAtSmallWaveNumbers) {
  EXPECT_EQ(kernel.fourier(0), 1);
  for (double x : {1e-150, 1e-8, 1e-4, 1e-2, 0.1}) {
    // 1 - Ŵ = x²/24 - x⁴/1080 + …: 630 · 4 (m+1)(m+2)/(2m+7)! for m = 1, 2
    const double expected = 1 - x * x / 24 + x * x * x * x * 2520 * 12 / 39916800;
    // The next term is x⁶ 2520·20/13!.
    EXPECT_NEAR(kernel.fourier(x / c), expected, 4 * epsilon + 1e-5 * std::pow(x, 6)) << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Cutoffs, Kernel, testing::Values(1.0, 2.4e-3, 17.5));

// Physics section 7: max |h³ΣW - 1| over offsets, two to four digits; and that no other place is worse.
TEST(GrainVolume, HasTheTabulatedErrors) {
  const std::pair<double, double> known[] = {{1, 1.089},    {1.25, .244}, {1.5, .0369}, {2, .0157},
                                             {2.5, 6.0e-4}, {3, 2.2e-3},  {4, 3.3e-4},  {6, 2.4e-5}};
  for (const auto& [cutoff, expected] : known) {
    const double worst = grain_volume_error(cutoff);
    EXPECT_NEAR(worst / expected, 1, 0.03) << cutoff;
    const LucyKernel kernel(cutoff);
    for (int place = 0; place < 50; ++place) {
      const double x[] = {std::fmod(0.618 * place, 1), std::fmod(0.414 * place, 1), std::fmod(0.732 * place, 1)};
      double sum = 0;
      for (int i = -7; i <= 7; ++i)
        for (int j = -7; j <= 7; ++j)
          for (int k = -7; k <= 7; ++k)
            sum += kernel.value(std::pow(x[0] - i, 2) + std::pow(x[1] - j, 2) + std::pow(x[2] - k, 2));
      EXPECT_LE(std::abs(sum - 1), worst * (1 + 1e-9)) << cutoff;
    }
  }
  EXPECT_EQ(grain_volume_error(12), grain_volume_error(6));
}

TEST(KernelConstruction, RefusesCutoffsThatAreNotPositiveAndFinite) {
  for (double c : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(LucyKernel{c}, std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::kernel_test
