#include "measure/least_squares.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random.hpp"

namespace grainvdb::least_squares_test {
namespace {

using ::testing::HasSubstr;

/// y = a + b x.
FitProblem line(std::vector<double> x, std::vector<double> y, std::vector<double> error = {}) {
  FitProblem problem;
  problem.observed = std::move(y);
  problem.error = std::move(error);
  problem.parameters = {{"a", 0, 1}, {"b", 0, 1}};
  problem.model = [x = std::move(x)](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    slopes[0] = 1;
    slopes[1] = x[k];
    return p[0] + p[1] * x[k];
  };
  return problem;
}

/// y = a exp(-b x) at x = 0, 1/4, 1/2, …
FitProblem decay(std::size_t count, double a, double b) {
  FitProblem problem;
  for (std::size_t k = 0; k < count; ++k) problem.observed.push_back(a * std::exp(-0.25 * b * static_cast<double>(k)));
  problem.parameters = {{"a", 1, 1}, {"b", 0.1, 1}};
  problem.model = [](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double x = 0.25 * static_cast<double>(k);
    slopes[0] = std::exp(-p[1] * x);
    slopes[1] = -p[0] * x * slopes[0];
    return p[0] * slopes[0];
  };
  return problem;
}

// The textbook's sums for a line: with S = Σ1/σ², Sx, Sxx and Δ = S Sxx - Sx², var a = Sxx/Δ, var b = S/Δ, cov = -Sx/Δ.
TEST(LeastSquares, WeightedLineHasTheTextbookCovariance) {
  const std::vector<double> x{-1, 0.5, 2, 3, 7}, y{1, 2.5, 2, 4, 8}, error{0.1, 0.2, 0.3, 0.1, 0.5};
  double s = 0, sx = 0, sxx = 0, sy = 0, sxy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double w = 1 / (error[k] * error[k]);
    s += w, sx += w * x[k], sxx += w * x[k] * x[k], sy += w * y[k], sxy += w * x[k] * y[k];
  }
  const double delta = s * sxx - sx * sx;
  const Fit fit = least_squares(line(x, y, error));
  ASSERT_TRUE(fit.fitted()) << fit.refusal;
  EXPECT_NEAR(fit.parameters[0], (sxx * sy - sx * sxy) / delta, 1e-12);
  EXPECT_NEAR(fit.parameters[1], (s * sxy - sx * sy) / delta, 1e-12);
  EXPECT_NEAR(fit.errors[0], std::sqrt(sxx / delta), 1e-14);
  EXPECT_NEAR(fit.errors[1], std::sqrt(s / delta), 1e-14);
  EXPECT_NEAR(fit.covariance[1], -sx / delta, 1e-14);
  EXPECT_EQ(fit.covariance[1], fit.covariance[2]);
  EXPECT_EQ(fit.freedom, 3U);
  EXPECT_EQ(fit.rank, 2U);
}

// Three points off a horizontal line by (1, -2, 1)/10: residuals of a straight fit, orthogonal to 1 and x.
TEST(LeastSquares, UnknownErrorsComeFromTheResiduals) {
  const Fit fit = least_squares(line({-1, 0, 1}, {1.1, 0.8, 1.1}));
  ASSERT_TRUE(fit.fitted()) << fit.refusal;
  EXPECT_NEAR(fit.parameters[0], 1, 1e-14);
  EXPECT_NEAR(fit.chi_square, 0.06, 1e-14);
  EXPECT_NEAR(fit.errors[0], std::sqrt(0.06 / 3), 1e-14);
  EXPECT_NEAR(fit.errors[1], std::sqrt(0.06 / 2), 1e-14);
  // JᵀJ = diag(3, 2).
  EXPECT_NEAR(fit.condition, std::sqrt(1.5), 1e-14);
}

// A parabola through eleven points is no line: of y = x² on [-1, 1] the line leaves x² - 2/5, whose squares sum to 1.4,
// so that errors of 0.1 make χ² 137 where 9 ± 4.2 is to be expected, and errors of 0.4 make it 8.6.
TEST(LeastSquares, DoubtsALawThatDoesNotDescribeTheValues) {
  std::vector<double> x, y;
  for (int k = -5; k <= 5; ++k) {
    x.push_back(0.2 * k);
    y.push_back(0.04 * k * k);
  }
  const Fit misfit = least_squares(line(x, y, std::vector<double>(x.size(), 0.1)));
  ASSERT_TRUE(misfit.fitted()) << misfit.refusal;
  double squares = 0;
  for (const double v : y) squares += (v - 0.4) * (v - 0.4);
  EXPECT_NEAR(misfit.chi_square, squares / 0.01, 1e-9);
  EXPECT_THAT(misfit.doubt, HasSubstr("for 9 degrees of freedom"));
  EXPECT_EQ(least_squares(line(x, y, std::vector<double>(x.size(), 0.4))).doubt, "");
  EXPECT_EQ(least_squares(line(x, y)).doubt, "");  // the residuals are all that is known of the errors
}

TEST(LeastSquares, NonlinearParametersAreFoundToRounding) {
  const Fit fit = least_squares(decay(20, 3.7, 1.9));
  ASSERT_TRUE(fit.fitted()) << fit.refusal;
  EXPECT_NEAR(fit.parameters[0], 3.7, 1e-12);
  EXPECT_NEAR(fit.parameters[1], 1.9, 1e-12);
  EXPECT_LT(fit.errors[0], 1e-12);
}

// The mean square of (estimate - truth)/error over trials is 1; its own standard deviation is √(2/trials) = 0.071.
TEST(LeastSquares, StandardErrorsAreThoseOfRepeatedTrials) {
  constexpr int trials = 400;
  testing::Random random(2024);
  double squares[2] = {0, 0};
  double reduced = 0;
  for (int t = 0; t < trials; ++t) {
    FitProblem problem = decay(20, 3.7, 1.9);
    problem.error.assign(20, 0.02);
    for (double& y : problem.observed) y += 0.02 * random.normal();
    const Fit fit = least_squares(problem);
    ASSERT_TRUE(fit.fitted()) << fit.refusal;
    squares[0] += std::pow((fit.parameters[0] - 3.7) / fit.errors[0], 2) / trials;
    squares[1] += std::pow((fit.parameters[1] - 1.9) / fit.errors[1], 2) / trials;
    reduced += fit.reduced_chi_square() / trials;
  }
  EXPECT_NEAR(squares[0], 1, 3 * 0.071);
  EXPECT_NEAR(squares[1], 1, 3 * 0.071);
  EXPECT_NEAR(reduced, 1, 3 * std::sqrt(2.0 / (18 * trials)));
}

TEST(LeastSquares, RefusesParametersThatOnlyOccurTogether) {
  FitProblem problem = line({1, 2, 3, 4}, {1, 2, 3, 4});
  problem.parameters = {{"a", 1, 1}, {"b", 1, 1}};
  problem.model = [](std::size_t k, std::span<const double> p, std::span<double> slopes) {
    const double x = static_cast<double>(k + 1);
    slopes[0] = p[1] * x;
    slopes[1] = p[0] * x;
    return p[0] * p[1] * x;
  };
  const Fit fit = least_squares(problem);
  EXPECT_FALSE(fit.fitted());
  EXPECT_EQ(fit.rank, 1U);
  EXPECT_GT(fit.condition, 1e10);
  EXPECT_TRUE(std::isnan(fit.parameters[0]) && std::isnan(fit.errors[1]) && std::isnan(fit.covariance[3]));
  EXPECT_TRUE(std::isnan(fit.reduced_chi_square()));
  EXPECT_THAT(fit.refusal, HasSubstr("1 of 2 parameters"));
  EXPECT_THAT(fit.refusal, HasSubstr("a, b"));
}

TEST(LeastSquares, RefusesAParameterWithoutEffect) {
  const Fit fit = least_squares(line({0, 0, 0, 0}, {1, 2, 3, 4}));
  EXPECT_EQ(fit.rank, 1U);
  EXPECT_TRUE(std::isinf(fit.condition));
  EXPECT_THAT(fit.refusal, HasSubstr("undetermined is b"));
}

// The slope of points within ±1e-3 has an error of 70 σ.
TEST(LeastSquares, RefusesWhatIsLostInNoise) {
  FitProblem problem = line({-1e-3, 1e-3, -1e-3, 1e-3}, {1, 2, 1, 2}, {1, 1, 1, 1});
  const Fit fit = least_squares(problem);
  EXPECT_EQ(fit.rank, 2U);
  EXPECT_THAT(fit.refusal, HasSubstr("do not determine b: its standard error 500 exceeds its scale 1"));
  problem.error.assign(4, 1e-3);
  EXPECT_TRUE(least_squares(problem).fitted());
}

// The condition number does not depend on units: scaling a parameter and its scale alike leaves it as it is.
TEST(LeastSquares, ConditionIsThatOfTheScaledJacobian) {
  FitProblem problem = line({-1, 0, 1}, {1.1, 0.8, 1.1});
  problem.parameters[1].scale = 10;
  EXPECT_NEAR(least_squares(problem).condition, std::sqrt(200.0 / 3), 1e-12);
  problem.condition_limit = 8;
  EXPECT_EQ(least_squares(problem).rank, 1U);
}

TEST(LeastSquares, RefusesTooFewObservations) {
  EXPECT_THAT(least_squares(line({0, 1}, {1, 2})).refusal, HasSubstr("2 observations for 2 parameters: at least 3"));
  const Fit exact = least_squares(line({0, 1}, {1, 2}, {0.1, 0.1}));
  ASSERT_TRUE(exact.fitted()) << exact.refusal;
  EXPECT_TRUE(std::isnan(exact.reduced_chi_square()));
  EXPECT_THAT(least_squares(line({}, {})).refusal, HasSubstr("0 observations"));
}

TEST(LeastSquares, ThrowsForWhatIsNoProblem) {
  EXPECT_THROW(least_squares(line({0, 1, 2}, {1, 2, NAN})), std::invalid_argument);
  EXPECT_THROW(least_squares(line({0, 1, 2}, {1, 2, 3}, {1, 1, 0})), std::invalid_argument);
  EXPECT_THROW(least_squares(line({0, 1, 2}, {1, 2, 3}, {1})), std::invalid_argument);
  FitProblem scale = line({0, 1, 2}, {1, 2, 3});
  scale.parameters[0].scale = 0;
  EXPECT_THROW(least_squares(scale), std::invalid_argument);
  FitProblem empty = line({0, 1, 2}, {1, 2, 3});
  empty.parameters.clear();
  EXPECT_THROW(least_squares(empty), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::least_squares_test
