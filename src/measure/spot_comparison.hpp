#pragma once
/// What estimators of the spot model's parameters make of runs whose parameters are known, taken off what they make of
/// others (indirect inference: Gourieroux, Monfort and Renault, J. Appl. Econometrics 8 (1993) S85). Pure functions.
#include <cstddef>
#include <string>
#include <utility>
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

/// What is compared: R, b, b_p, Q, 1/c. The last is how much looser flow is for its flux, and can be seen as 0 or less.
enum class SpotObservable { radius, b, grain_diffusion, outflow, slowness };
inline constexpr std::size_t spot_observable_count = 5;

/// Rounds of runs, each round with other parameters. What is seen is a line of what would be seen if the estimators
/// were right: of logarithms, but for the slowness. Its slope is near 1 unless runs say otherwise.
class SpotComparison {
 public:
  explicit SpotComparison(SpotObservations seen) : seen_(std::move(seen)) {}

  /// What those parameters would be seen as, in grains as dense as those of the dumps: R, b, b_p = s b/w, Q = λN/w,
  /// 1/c.
  std::vector<double> expected(const SpotTruth& made) const;
  static std::vector<double> observed(const SpotObservations& seen);

  /// Runs with the same parameters, but for their seed; at least two. Returns the names of what they do not tell: each
  /// run must give a number above 0, or any number for the slowness. The round counts only where nothing is missing.
  std::vector<std::string> add_round(const SpotTruth& made, const std::vector<SpotObservations>& runs);

  /// What the last round was seen as, over what it would be seen as; of the slowness the difference. With the error of
  /// the mean.
  std::vector<Estimate> biases() const;

  /// What was seen in the dumps, by lines through the last two rounds. The errors are those of the dumps, of the last
  /// round and of 0.3 of the slopes; the first two are no less than what runs with the same parameters scatter by. For
  /// the dumps that is the scatter times √duration_ratio, the time that is measured of a run over that of the dumps.
  /// The speed is NaN where no slowness is left, and its error no more than itself: it is told to a factor of two then,
  /// or not at all.
  SpotObservations corrected(double duration_ratio = 1) const;

 private:
  struct Run {
    std::size_t round;
    double made, seen;  ///< logarithms, or slownesses
    double stated;      ///< error of what was seen, in the same way
  };
  double scatter(std::size_t observable) const;
  Estimate inverted(std::size_t observable, double seen, double error) const;

  SpotObservations seen_;
  std::size_t rounds_ = 0;
  std::vector<std::vector<Run>> runs_{spot_observable_count};  ///< of each observable
};

}  // namespace grainvdb
