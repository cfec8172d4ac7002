#pragma once
/// Fits of the laws of μ(I) and ν(I, p*) (physics section 4) to measured values.
#include <vector>

#include "grainvdb/laws.hpp"
#include "measure/least_squares.hpp"

namespace grainvdb {

/// μ or ν against I, and against p* = P d/k_n for soft grains.
struct RheologyData {
  std::vector<double> inertial_number;  ///< > 0
  std::vector<double> soft_pressure;    ///< p* ≥ 0; empty: rigid grains, p* = 0
  std::vector<double> value;
  std::vector<double> error;  ///< standard errors of the values; empty: equal and unknown
};

struct FrictionLawFit {
  Fit fit;                  ///< of μ₀, μ_∞ and ln I₀, and of 1/√p₀* for soft grains
  SoftFrictionLaw law{};    ///< p₀* infinite for rigid grains; NaN where the fit was refused
  SoftFrictionLaw error{};  ///< standard errors; 0 for a p₀* that was not fitted
};

/// μ(I) = μ₀ + (μ_∞-μ₀)/(I₀/I+1), times 1 - √(p*/p₀*) where p* is given. I₀ is fitted as its logarithm, σ(I₀) =
/// I₀ σ(ln I₀), and p₀* as s = 1/√p₀*, σ(p₀*) = 2σ_s/s³. The scales are the largest |μ| of the data for μ₀ and μ_∞, 1
/// for ln I₀, and for s that at which the correction is 1. Refused as least_squares refuses: values of I on one side of
/// I₀ determine two of three parameters. Refused as well where s is not two errors above 0: grains that show no
/// softness have no p₀*.
FrictionLawFit fit_friction_law(const RheologyData& data, double condition_limit);

struct PackingLawFit {
  Fit fit;             ///< of ν_c and 1/I_c, and of 1/p_c* for soft grains
  PackingLaw law{};    ///< p_c* infinite for rigid grains; NaN where the fit was refused
  PackingLaw error{};  ///< standard errors; 0 for a p_c* that was not fitted
};

/// ν(I, p*) that solves ν = ν_c (1+p*/p_c*) (1 - I√ν/I_c), with slopes by the implicit law. The scales are the largest
/// ν of the data for ν_c, and for 1/I_c and 1/p_c* the inverse of the largest I and p*. Refused as least_squares
/// refuses, and where 1/I_c or 1/p_c* is not two errors above 0.
PackingLawFit fit_packing_law(const RheologyData& data, double condition_limit);

}  // namespace grainvdb
