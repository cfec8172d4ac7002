#include "measure/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <Eigen/SVD>
#include <unsupported/Eigen/NonLinearOptimization>

#include "base/nan.hpp"

namespace grainvdb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string text_of(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

std::size_t place(Index i) {
  return static_cast<std::size_t>(i);
}

/// Residuals (f_k - y_k)/σ_k and their derivatives by p_j/scale_j, as Eigen's solver calls for them.
class Residuals {
 public:
  using Scalar = double;

  explicit Residuals(const FitProblem& problem)
      : problem_(problem), p_(problem.parameters.size()), slopes_(problem.parameters.size()) {}

  Index observations() const { return static_cast<Index>(problem_.observed.size()); }
  int values() const { return static_cast<int>(problem_.observed.size()); }

  int operator()(const VectorXd& scaled, VectorXd& residuals) {
    set(scaled);
    for (Index k = 0; k < observations(); ++k) residuals[k] = (model(k) - problem_.observed[place(k)]) * weight(k);
    return 0;
  }

  int df(const VectorXd& scaled, MatrixXd& jacobian) {
    set(scaled);
    for (Index k = 0; k < observations(); ++k) {
      model(k);
      for (Index j = 0; j < jacobian.cols(); ++j)
        jacobian(k, j) = slopes_[place(j)] * problem_.parameters[place(j)].scale * weight(k);
    }
    return 0;
  }

 private:
  void set(const VectorXd& scaled) {
    for (std::size_t j = 0; j < p_.size(); ++j) p_[j] = scaled[static_cast<Index>(j)] * problem_.parameters[j].scale;
  }
  double model(Index k) { return problem_.model(place(k), p_, slopes_); }
  double weight(Index k) const { return problem_.error.empty() ? 1 : 1 / problem_.error[place(k)]; }

  const FitProblem& problem_;
  std::vector<double> p_;
  std::vector<double> slopes_;
};

void check(const FitProblem& problem) {
  const auto finite = [](double x) { return std::isfinite(x); };
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (problem.parameters.empty() || !problem.model) throw std::invalid_argument("a fit needs a model with parameters");
  if (!problem.error.empty() && problem.error.size() != problem.observed.size())
    throw std::invalid_argument("a fit needs one standard error for each observation, or none");
  if (!std::all_of(problem.observed.begin(), problem.observed.end(), finite) ||
      !std::all_of(problem.error.begin(), problem.error.end(), positive))
    throw std::invalid_argument("a fit needs finite observations with positive standard errors");
  for (const FitParameter& p : problem.parameters)
    if (!finite(p.start) || !positive(p.scale))
      throw std::invalid_argument("a fit needs finite starts and positive scales");
}

/// Sets condition and rank, and says which parameters the data do not determine.
void test_rank(const FitProblem& problem, const VectorXd& singular, const MatrixXd& axes, Fit& fit) {
  const Index last = singular.size() - 1;
  fit.condition = singular[last] > 0 ? singular[0] / singular[last] : std::numeric_limits<double>::infinity();
  for (Index i = 0; i <= last; ++i)
    if (singular[i] > 0 && singular[0] <= problem.condition_limit * singular[i]) ++fit.rank;
  if (fit.rank == problem.parameters.size()) return;
  // What can be changed freely: the parameters that take part in the direction of the least singular value.
  std::string names;
  for (Index j = 0; j <= last; ++j)
    if (std::abs(axes(j, last)) > 0.1) names += (names.empty() ? "" : ", ") + problem.parameters[place(j)].name;
  fit.refusal = "the data determine " + std::to_string(fit.rank) + " of " + std::to_string(problem.parameters.size()) +
                " parameters (condition number " + text_of(fit.condition) + ", limit " +
                text_of(problem.condition_limit) + "): undetermined is " + names;
}

/// (JᵀJ)⁻¹ = V S⁻² Vᵀ in the unit of the parameters.
void set_errors(const FitProblem& problem, const VectorXd& singular, const MatrixXd& axes, Fit& fit) {
  const double noise = problem.error.empty() ? fit.reduced_chi_square() : 1;
  const MatrixXd half = axes * singular.cwiseInverse().asDiagonal();
  const MatrixXd scaled = noise * (half * half.transpose());
  const std::size_t n = problem.parameters.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double scale = problem.parameters[i].scale;
    for (std::size_t j = 0; j < n; ++j)
      fit.covariance[i * n + j] =
          scaled(static_cast<Index>(i), static_cast<Index>(j)) * scale * problem.parameters[j].scale;
    fit.errors[i] = std::sqrt(fit.covariance[i * n + i]);
    if (fit.errors[i] > scale && fit.fitted())
      fit.refusal = "the data do not determine " + problem.parameters[i].name + ": its standard error " +
                    text_of(fit.errors[i]) + " exceeds its scale " + text_of(scale);
  }
}

void doubt_misfit(const FitProblem& problem, Fit& fit) {
  const auto freedom = static_cast<double>(fit.freedom);
  if (problem.error.empty() || !(fit.chi_square > freedom + 4 * std::sqrt(2 * freedom))) return;
  fit.doubt = "chi^2 is " + text_of(fit.chi_square) + " for " + std::to_string(fit.freedom) +
              " degrees of freedom: the law does not describe the values within their errors, or these are not "
              "independent, and the errors of the parameters are too small";
}

void forget_parameters(Fit& fit) {
  for (std::vector<double>* values : {&fit.parameters, &fit.errors, &fit.covariance})
    std::fill(values->begin(), values->end(), nan);
}

}  // namespace

double Fit::reduced_chi_square() const {
  return fitted() && freedom > 0 ? chi_square / static_cast<double>(freedom) : nan;
}

Fit least_squares(const FitProblem& problem) {
  check(problem);
  const std::size_t n = problem.parameters.size();
  Fit fit;
  fit.parameters.assign(n, nan);
  fit.errors.assign(n, nan);
  fit.covariance.assign(n * n, nan);

  // Without given errors, one observation more is needed to estimate them from.
  const std::size_t fewest = problem.error.empty() ? n + 1 : n;
  if (problem.observed.size() < fewest) {
    fit.refusal = std::to_string(problem.observed.size()) + " observations for " + std::to_string(n) +
                  " parameters: at least " + std::to_string(fewest) + " are needed";
    return fit;
  }
  fit.freedom = problem.observed.size() - n;

  VectorXd scaled(static_cast<Index>(n));
  for (std::size_t j = 0; j < n; ++j)
    scaled[static_cast<Index>(j)] = problem.parameters[j].start / problem.parameters[j].scale;
  Residuals residuals(problem);
  Eigen::LevenbergMarquardt<Residuals> solver(residuals);
  solver.parameters.ftol = solver.parameters.xtol = 1e-14;
  solver.parameters.maxfev = 2000;
  const auto status = solver.minimize(scaled);

  VectorXd at_minimum(residuals.observations());
  residuals(scaled, at_minimum);
  fit.chi_square = at_minimum.squaredNorm();
  // Beyond these the step or the gain is below rounding, or it ran out of evaluations, or it met what is no number.
  const bool converged = status >= Eigen::LevenbergMarquardtSpace::RelativeReductionTooSmall &&
                         status != Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation;
  if (!converged || !std::isfinite(fit.chi_square)) {
    fit.refusal = "the fit does not converge: the data do not constrain it";
    return fit;
  }

  MatrixXd jacobian(residuals.observations(), static_cast<Index>(n));
  residuals.df(scaled, jacobian);
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian, Eigen::ComputeThinV);
  test_rank(problem, svd.singularValues(), svd.matrixV(), fit);
  for (std::size_t j = 0; j < n; ++j) fit.parameters[j] = scaled[static_cast<Index>(j)] * problem.parameters[j].scale;
  if (fit.fitted()) set_errors(problem, svd.singularValues(), svd.matrixV(), fit);
  if (!fit.fitted()) {
    forget_parameters(fit);
  } else {
    doubt_misfit(problem, fit);
  }
  return fit;
}

}  // namespace grainvdb
