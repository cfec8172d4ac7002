#pragma once
/// What estimators of the spot model's parameters make of runs whose parameters are known, taken off what they make of
/// others (indirect inference). Pure functions.
#include <cstddef>
#include <string>
#include <vector>

#include "measure/spot_parameters.hpp"

namespace grainvdb {

/// What a spot run was made with.
struct SpotTruth {
  double radius = 0;          ///< r_s [length]
  double b = 0;               ///< Δx²/(2Δz) [length]
  double influence = 0;       ///< w
  double insertion_rate = 0;  ///< λ [1/time]
  double speed = 0;           ///< μ_s Δz [length/time]
};

/// What is corrected, in that order.
inline constexpr std::size_t spot_observable_count = 5;
enum class SpotObservable { radius, b, grain_diffusion, outflow, slowness };

/// Of R, b, b_p, Q ratios of what was observed to what made it; of the slowness 1/c a difference, for it can be
/// observed as 0 or less. [1, or time/length]
struct SpotBias {
  Estimate bias;       ///< with the error of the mean over runs
  double scatter = 0;  ///< standard deviation of one run; relative for ratios
};

/// Rounds of runs, each round with other parameters.
class SpotComparison {
 public:
  explicit SpotComparison(SpotObservations seen) : seen_(std::move(seen)) {}

  /// What those parameters would have been seen as if the estimators were right, in grains as dense as those of the
  /// dumps: R, b, b_p = s b/w, Q = λN/w, 1/c, in the order of SpotObservable.
  std::vector<double> expected(const SpotTruth& made) const;
  /// The same of what was seen.
  static std::vector<double> observed(const SpotObservations& seen);

  /// Runs with the same parameters, but for their seed. Returns the names of what they do not tell, for which there
  /// must be a number above 0 in each run (of the slowness, a number); the round counts only where there are none.
  std::vector<std::string> add_round(const SpotTruth& made, const std::vector<SpotObservations>& runs);

  /// By the runs of the last round. Scatter is that within all rounds, or what the estimators state, where that is
  /// more.
  std::vector<SpotBias> biases() const;

  /// What was seen in the dumps, less the biases. Errors contain those of the biases; and each is at least the scatter
  /// of one run of the same parameters, times √duration_ratio: runs of that part of the dumps' duration. The speed is
  /// NaN where none is left.
  SpotObservations corrected(double duration_ratio = 1) const;

 private:
  struct Round {
    std::vector<std::vector<double>> biases;  ///< of each observable, of each run; logarithms of ratios
  };
  SpotObservations seen_;
  std::vector<Round> rounds_;
  std::vector<std::vector<double>> stated_;  ///< errors of each observable, of each run of all rounds; relative
};

}  // namespace grainvdb
