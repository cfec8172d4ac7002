// The mean of W along a branch from its value and second derivative in the middle.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/line_rule.hpp"

namespace grainvdb::line_curvature_test {
namespace {

const double cutoff = 1.3;
const LucyKernel kernel(cutoff);
const double peak = 105 / (16 * std::numbers::pi * cutoff * cutoff * cutoff);

/// Of a branch of so many cutoffs along (3, 0, 4)/5 with its middle at t along it and b beside it.
struct Branch {
  Branch(double length, double b, double t) {
    const Vec3 e{0.6, 0, 0.8}, side{0, 1, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = cutoff * length * e[k];
      p[k] = cutoff * (b * side[k] + (t - length / 2) * e[k]);
    }
  }
  Vec3 p{}, a{};
};

struct Extremes {
  double error = 0, least = 1;
};
/// In units of W(0), over all places.
Extremes extremes(double length) {
  Extremes found;
  const auto look = [&](double b, double t) {
    const Branch branch(length, b, t);
    const double value = kernel.line_integral_midpoint_curvature(branch.p, branch.a) / peak;
    found.error = std::max(found.error, std::abs(value - kernel.line_integral(branch.p, branch.a) / peak));
    found.least = std::min(found.least, value);
  };
  for (int i = 0; i <= 60; ++i)
    for (int j = 0; j <= 150; ++j) look(1.5 * length * i * i / 3600, 1.5 * length * j / 150);
  for (int i = 0; i <= 240; ++i)
    for (int j = 0; j <= 240; ++j) look(i / 240.0, (1 + length / 2) * j / 240);
  const double rim = length * length / 12;
  look(1 - rim, 0);
  return found;
}

// W + (a·∇)²W/24 with the derivative by differences of W itself: h⁴ and rounding over h² are below 1e-7 there.
TEST(LineCurvature, IsTheValueAndTheSecondDerivativeInTheMiddle) {
  for (const auto& [b, t] : {std::pair{0.3, 0.2}, {0.1, -0.6}, {0.7, 0.05}, {0.0, 0.4}}) {
    const double length = 0.2, h = 1e-3;
    const Branch branch(length, b, t);
    const auto value_at = [&](double s) {
      Vec3 x{};
      for (std::size_t k = 0; k < 3; ++k) x[k] = branch.p[k] + (0.5 + s) * branch.a[k];
      return kernel.value(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    };
    const double second = (value_at(h) - 2 * value_at(0) + value_at(-h)) / (h * h);
    EXPECT_NEAR(kernel.line_integral_midpoint_curvature(branch.p, branch.a), value_at(0) + second / 24, 1e-7 * peak);
  }
}

// The largest error is that of 8 q³ on a branch which the centre bisects, e³/4, less 3 q⁴ there, 3 e⁴/80.
TEST(LineCurvature, ErrsByAQuarterOfTheLengthCubed) {
  for (const double length : {0.05, 0.1, 1.0 / 6, longest_curved_branch}) {
    const double bound = std::pow(length, 3) / 4;
    const Extremes found = extremes(length);
    EXPECT_LT(found.error, bound) << length;
    EXPECT_NEAR(found.error, bound - 3 * std::pow(length, 4) / 80, 1e-6 * bound) << length;
  }
  EXPECT_NEAR(extremes(1.0 / 6).error, 1.13e-3, 1e-5);
  EXPECT_LT(extremes(longest_curved_branch).error, curved_branch_error);
}

// Beside the middle near the rim (1-q)² [4 (1-q) - e²/2] is least at 1-q = e²/12.
TEST(LineCurvature, IsHardlyNegativeNearTheRim) {
  for (const double length : {0.1, longest_curved_branch}) {
    const double least = -std::pow(length, 6) / 864;
    EXPECT_GT(extremes(length).least, 1.01 * least);
    EXPECT_LT(extremes(length).least, 0.9 * least);
  }
  const Branch outside(0.2, 1, 0);
  EXPECT_EQ(kernel.line_integral_midpoint_curvature(outside.p, outside.a), 0);
}

TEST(LineCurvature, OfNoLengthIsTheKernelAndInTheCentreFinite) {
  const Branch none(0, 0.3, 0.2);
  EXPECT_NEAR(kernel.line_integral_midpoint_curvature(none.p, none.a), kernel.value(0.13 * cutoff * cutoff),
              1e-15 * peak);
  const Branch bisected(0.2, 0, 0);
  EXPECT_NEAR(kernel.line_integral_midpoint_curvature(bisected.p, bisected.a), peak * (1 - 0.02), 1e-14 * peak);
}

TEST(LineCurvature, LongBranchesAreDivided) {
  EXPECT_EQ(curved_branch_parts(0), 1);
  EXPECT_EQ(curved_branch_parts(0.2), 1);
  EXPECT_EQ(curved_branch_parts(0.21), 2);
  EXPECT_EQ(curved_branch_parts(1.5), 8);
}

}  // namespace
}  // namespace grainvdb::line_curvature_test
