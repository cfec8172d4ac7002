#pragma once
/// The parameters of the spot model from what is measured of a flow. Pure functions.
#include <vector>

#include "grainvdb/table.hpp"
#include "measure/estimate.hpp"

namespace grainvdb {

/// What is measured.
struct SpotObservations {
  Estimate radius;            ///< R of the velocity correlation [length]
  Estimate b;                 ///< of ∂v/∂z = b ∂²v/∂x², from the growth of profiles [length]
  Estimate grain_diffusion;   ///< b_p: half the slope of the variance of displacements against the way fallen [length]
  Estimate number_density;    ///< of grains, in the flow [1/length³]
  Estimate outflow;           ///< Q, grains per time [1/time]
  Estimate speed;             ///< of spots [length/time]
  std::vector<double> times;  ///< lags of displacements that b_p was fitted to [time]
  double rise = 0;            ///< Δz of a step, which is chosen, not measured [length]
};

/// What follows, with errors by linear propagation of those above, as if these were independent of each other.
struct SpotParameterEstimates {
  Estimate step;            ///< Δx = Δy = √(2 b Δz) [length]
  Estimate share;           ///< s of b_p = s b/w (see DiffusionShare), in the slope over the lags [1]
  Estimate influence;       ///< w = s b/b_p [1]
  Estimate grains;          ///< N = n 4/3 π R³ [1]
  Estimate volume;          ///< V_s/V_p = N/w [1]
  Estimate hop_rate;        ///< μ_s = speed/Δz [1/time]
  Estimate insertion_rate;  ///< λ = Q w/N: each spot lets N/w grains through every plane on its way up [1/time]
};

/// NaN where what it takes is NaN, or not positive.
SpotParameterEstimates spot_parameters(const SpotObservations& observed);

/// Both as numbers of a table: what is observed, and what follows.
std::vector<Quantity> spot_quantities(const SpotObservations& observed, const SpotParameterEstimates& parameters);

/// The observations that a table with these numbers, `phi` and a column `time` was made of. Throws std::out_of_range
/// where one of them is missing.
SpotObservations spot_observations(const Table& table);

}  // namespace grainvdb
