#pragma once
/// The fit of the fluidity law (A20) to measured values of gd/δv.
#include <string>
#include <vector>

#include "grainvdb/laws.hpp"
#include "measure/least_squares.hpp"

namespace grainvdb {

/// gd/δv against φ.
struct FluidityData {
  std::vector<double> phi;
  std::vector<double> value;
  std::vector<double> error;  ///< standard errors of the values; empty: equal and unknown
};

struct FluidityLawFit {
  Fit fit;              ///< of A, B, w = √C and k = 1/D; of A, B and k where C was held
  FluidityLaw law{};    ///< NaN where the fit was refused
  FluidityLaw error{};  ///< standard errors of A, B, C and D; 0 for a C that was held
};

/// A, B, C and D of F(φ) = A - [(φ-B)+√((φ-B)²+C)]/D (A20) by weighted least squares. Fitted are w = √C and k = 1/D, in
/// which F is finite everywhere and nearly linear; errors follow as σ_C = 2wσ_w and σ_D = σ_k/k². The scales of A, B, w
/// and k are A, A/2k (over which F falls from A to 0), w and k.
///
/// With a plateau alone or a falling branch alone four parameters are not determined: the condition number, some 35 to
/// 190 for the laws of Table IV with both branches, is then above 2000 but for the widest of knees. Refused where it
/// exceeds `condition_limit`, as are fits that rise with φ, and other fits that least_squares refuses.
FluidityLawFit fit_fluidity_law(const FluidityData& data, double condition_limit);

/// The same with C held.
FluidityLawFit fit_fluidity_law_with(double c, const FluidityData& data, double condition_limit);

}  // namespace grainvdb
