#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>

#include "measure/velocity_correlation.hpp"

namespace grainvdb {
namespace {

using Eigen::VectorXd;

/// Residuals A f(r; R) - c in the parameters (A, R).
struct Residuals {
  using Scalar = double;
  using InputType = VectorXd;
  using ValueType = VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const std::vector<double>& r;
  const std::vector<double>& c;

  int inputs() const { return 2; }
  int values() const { return static_cast<int>(r.size()); }

  int operator()(const VectorXd& p, VectorXd& residual) const {
    for (std::size_t k = 0; k < r.size(); ++k)
      residual[static_cast<Eigen::Index>(k)] = p[0] * sphere_law(r[k], p[1]) - c[k];
    return 0;
  }

  int df(const VectorXd& p, Eigen::MatrixXd& jacobian) const {
    const double radius = p[1];
    for (std::size_t k = 0; k < r.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double q = r[k] / radius;
      jacobian(row, 0) = sphere_law(r[k], radius);
      jacobian(row, 1) = q < 2 ? p[0] * (0.75 * q - 0.1875 * q * q * q) / radius : 0;
    }
    return 0;
  }
};

/// The radius of a number of them that fits best, with its best amplitude: where the descent starts.
VectorXd best_of_many(const std::vector<double>& r, const std::vector<double>& c) {
  constexpr int tries = 64;
  VectorXd best(2);
  double least = std::numeric_limits<double>::infinity();
  for (int t = 1; t <= tries; ++t) {
    const double radius = r.back() * t / tries;
    double ff = 0, fc = 0, cc = 0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      const double f = sphere_law(r[k], radius);
      ff += f * f;
      fc += f * c[k];
      cc += c[k] * c[k];
    }
    if (!(ff > 0) || !(cc - fc * fc / ff < least)) continue;
    least = cc - fc * fc / ff;
    best << fc / ff, radius;
  }
  return best;
}

}  // namespace

double sphere_law(double r, double radius) {
  const double q = r / radius;
  return q < 2 ? 1 - 0.75 * q + 0.0625 * q * q * q : 0;
}

SphereFit fit_sphere_law(const std::vector<double>& r, const std::vector<double>& c) {
  constexpr SphereFit none{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  if (r.size() < 3) return none;
  VectorXd p = best_of_many(r, c);
  Residuals residuals{r, c};
  Eigen::LevenbergMarquardt<Residuals> solver(residuals);
  solver.parameters.ftol = solver.parameters.xtol = 1e-12;
  const auto status = solver.minimize(p);
  const bool ended = status > 0 && status != Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation;
  return ended && p[1] > 0 ? SphereFit{p[0], p[1]} : none;
}

}  // namespace grainvdb
