#pragma once
/// Weighted nonlinear least squares with standard errors, and with a clear refusal of data that do not determine the
/// parameters.
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace grainvdb {

struct FitParameter {
  std::string name;
  double start = 0;
  double scale = 1;  ///< > 0: the size of a change of it that matters, in its own unit
};

/// y_k = f_k(p) + noise of standard deviation σ_k.
struct FitProblem {
  std::vector<double> observed;  ///< y_k
  std::vector<double> error;     ///< σ_k > 0; empty: equal and unknown, estimated from the residuals
  std::vector<FitParameter> parameters;
  /// f_k(p); writes ∂f_k/∂p_j to `slopes`. Must be finite for any finite p.
  std::function<double(std::size_t k, std::span<const double> p, std::span<double> slopes)> model;
  /// The largest condition number of the scaled Jacobian with which a fit is not refused.
  double condition_limit = 1e4;
};

struct Fit {
  std::string refusal;             ///< why there is no fit, in a sentence; empty where there is one
  std::string doubt;               ///< why a fit is hardly to be trusted, in a sentence; empty where nothing says so
  std::vector<double> parameters;  ///< NaN where the fit was refused
  std::vector<double> errors;      ///< standard errors; NaN where the fit was refused
  std::vector<double> covariance;  ///< row by row; NaN where the fit was refused
  double chi_square = std::numeric_limits<double>::quiet_NaN();  ///< Σ ((y_k - f_k)/σ_k)², with σ_k = 1 if unknown
  std::size_t freedom = 0;                                       ///< observations - parameters
  double condition = std::numeric_limits<double>::quiet_NaN();   ///< of the scaled Jacobian; infinite if it is singular
  std::size_t rank = 0;  ///< of it: how many combinations of the parameters the data determine

  bool fitted() const { return refusal.empty(); }
  /// χ² by degree of freedom: near 1 where the law describes the data within their errors. NaN where the fit was
  /// refused or has no freedom.
  double reduced_chi_square() const;
};

/// Minimises χ² = Σ ((y_k - f_k(p))/σ_k)² with MINPACK's lmder (as Eigen keeps it). With the Jacobian J_kj =
/// (∂f_k/∂p_j)/σ_k at the minimum, the covariance is (JᵀJ)⁻¹ where the σ_k are given, and (JᵀJ)⁻¹ χ²/(n-m) where they
/// are not. Its singular values are those of J with column j multiplied by the scale of p_j; their ratio is the
/// condition number, and the rank counts those above the largest over condition_limit.
///
/// Refused, with the reason in words: too few observations; no convergence; a rank below the number of parameters; a
/// standard error above the scale of its parameter, which is then not known even to its order of magnitude. Doubted is
/// a fit to given errors whose χ² lies four standard deviations √(2(n-m)) above its mean n-m: the law, or the
/// independence of the errors, fails, and the errors of the parameters do not tell. Throws std::invalid_argument where
/// sizes do not agree, or a number is not finite or not positive where it must be.
Fit least_squares(const FitProblem& problem);

}  // namespace grainvdb
