#include "grainvdb/line_rule.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"

namespace grainvdb::line_rule_test {
namespace {

const LucyKernel kernel(1);
const double peak = 105 / (16 * std::numbers::pi);

/// The error in units of W(0) on a branch along x whose middle is at (t, b).
double error(int n, double length, double b, double t) {
  const Vec3 p{t - length / 2, b, 0}, a{length, 0, 0};
  return std::abs(kernel.line_integral(p, a, lucy_rule(n)) - kernel.line_integral(p, a)) / peak;
}

/// The largest over all places: fine near the centre, where r³ bends, coarser as far as the rim.
double largest_error(int n, double length) {
  double worst = 0;
  const double half = length / 2;
  for (int i = 0; i <= 60; ++i)
    for (int j = 0; j <= 150; ++j)
      worst = std::max(worst, error(n, length, 3 * half * i * i / 3600, 3 * half * j / 150));
  for (int i = 0; i <= 120; ++i)
    for (int j = 0; j <= 120; ++j) worst = std::max(worst, error(n, length, i / 120.0, (1 + half) * j / 120));
  return worst;
}

TEST(LineRules, AreSymmetricAscendingAndNormalised) {
  for (int n = 1; n <= 8; ++n)
    for (const auto rule : {gauss_rule(n), lucy_rule(n)}) {
      ASSERT_EQ(rule.size(), static_cast<std::size_t>(n));
      double sum = 0;
      for (std::size_t k = 0; k < rule.size(); ++k) {
        sum += rule[k].weight;
        EXPECT_GT(rule[k].weight, 0);
        EXPECT_LT(std::abs(rule[k].x), 1);
        EXPECT_EQ(rule[k].x, -rule[rule.size() - 1 - k].x);
        EXPECT_EQ(rule[k].weight, rule[rule.size() - 1 - k].weight);
        if (k > 0) {
          EXPECT_GT(rule[k].x, rule[k - 1].x);
        }
      }
      EXPECT_NEAR(sum, 2, 1e-9) << n;  // ten digits of every weight
    }
}

TEST(LineRules, RefuseOtherNumbersOfPoints) {
  for (const int n : {-1, 0, 9}) {
    EXPECT_THROW(gauss_rule(n), std::invalid_argument);
    EXPECT_THROW(lucy_rule(n), std::invalid_argument);
    EXPECT_THROW(longest_branch(n), std::invalid_argument);
  }
}

TEST(LucyRules, KeepTheirErrorUpToTheirLongestBranch) {
  for (int n = 1; n <= 8; ++n) {
    const double longest = longest_branch(n);
    for (const double part : {1.0, 0.99, 0.9, 0.75, 0.5, 0.2, 0.01})
      EXPECT_LT(largest_error(n, part * longest), lucy_rule_error) << n << " points, " << part * longest;
    EXPECT_GT(largest_error(n, 1.05 * longest), lucy_rule_error) << n;
  }
}

TEST(LucyRules, NeedFewerPointsThanGaussRules) {
  // 3 points for a half branch of c/6 and 5 for a whole one of c/3, where Gauss-Legendre rules take 4 and 6.
  EXPECT_EQ(divide_branch(1.0 / 6).points, 3);
  EXPECT_EQ(divide_branch(1.0 / 3).points, 5);
  const auto gauss_error = [](int n, double length) {
    const Vec3 p{-length / 2, 0, 0}, a{length, 0, 0};
    return std::abs(kernel.line_integral_gauss(p, a, n) - kernel.line_integral(p, a)) / peak;
  };
  EXPECT_GT(gauss_error(3, 1.0 / 6), lucy_rule_error);
  EXPECT_GT(gauss_error(5, 1.0 / 3), lucy_rule_error);
}

TEST(BranchDivision, TakesTheFewestPoints) {
  EXPECT_EQ(divide_branch(0).points, 1);
  for (int n = 1; n <= 8; ++n) {
    EXPECT_EQ(divide_branch(longest_branch(n)).points, n);
    EXPECT_EQ(divide_branch(longest_branch(n)).parts, 1);
  }
  for (int n = 1; n < 8; ++n) {
    EXPECT_EQ(divide_branch(longest_branch(n) * 1.0001).points, n + 1);
  }
}

TEST(BranchDivision, DividesOnlyWhatIsTooLongForTheLargestRule) {
  const double longest = longest_branch(8);
  EXPECT_EQ(divide_branch(1.001 * longest).parts, 2);
  EXPECT_EQ(divide_branch(1.001 * longest).points, 5);
  EXPECT_EQ(divide_branch(1.999 * longest).parts, 2);
  EXPECT_EQ(divide_branch(1000 * longest).parts, 1000);
}

TEST(AdaptiveLineIntegral, KeepsItsErrorOnBranchesOfAllLengths) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  double worst = 0;
  for (int k = 0; k < 300000; ++k) {
    const double length = 3 * std::pow(uniform(random), 2);
    // Half of them pass within a tenth of their length of the centre, where rules err most.
    const double b = (k % 2 == 0 ? 1.0 : 0.1 * length) * uniform(random), t = (1 + length / 2) * uniform(random);
    const Vec3 p{t - length / 2, b, 0}, a{length, 0, 0};
    worst = std::max(worst, std::abs(kernel.line_integral_adaptive(p, a) - kernel.line_integral(p, a)) / peak);
  }
  EXPECT_LT(worst, lucy_rule_error);
  EXPECT_GT(worst, 0.8 * lucy_rule_error);
}

TEST(AdaptiveLineIntegral, OfNoLengthIsTheKernel) {
  EXPECT_DOUBLE_EQ(kernel.line_integral_adaptive({0.3, 0.2, 0}, {0, 0, 0}), kernel.value(0.13));
}

TEST(Reach, IsThatOfTheNearestPointOfTheBranch) {
  EXPECT_TRUE(kernel.reaches({0, 0.999, -1}, {0, 0, 2}));
  EXPECT_FALSE(kernel.reaches({0, 1, -1}, {0, 0, 2}));
  EXPECT_TRUE(kernel.reaches({0, 0, 0.999}, {0, 0, 5}));
  EXPECT_FALSE(kernel.reaches({0, 0, 1}, {0, 0, 5}));
  EXPECT_FALSE(kernel.reaches({0, 0, -3}, {0, 0, 2}));
  EXPECT_TRUE(kernel.reaches({0, 0, -3}, {0, 0, 2.001}));
  EXPECT_TRUE(kernel.reaches({0.5, 0.5, 0.5}, {0, 0, 0}));
  EXPECT_FALSE(kernel.reaches({0.6, 0.6, 0.6}, {0, 0, 0}));
}

}  // namespace
}  // namespace grainvdb::line_rule_test
