#pragma once
/// Mean squared deviation of a particle vector from its local mean: granular temperature (of velocities) and rotational
/// fluctuation (of angular velocities) are formed alike.
#include <array>
#include <string>
#include <vector>

#include "grainvdb/moment.hpp"
#include "grainvdb/options.hpp"

namespace grainvdb {

/// Which vector fluctuates, and about which mean.
struct Fluctuating {
  std::string label;            ///< for the names of moments
  Column column;                ///< to be read
  Columns3 Particles::*vector;  ///< q_α
  MomentPtr mean_numerator;     ///< Σ w q W, three channels
  MomentPtr mean_denominator;   ///< Σ w W
};

/// The ways to form the deviation (physics section 3).
inline const std::vector<std::string> fluctuation_modes{"two_pass", "two_pass_profile", "one_pass"};

/// Σ V |q_α - q̃(x_α)|² W with q̃ the mean of the frame by `mode`: interpolated from the voxels (two_pass), averaged over
/// the homogeneous axes first (two_pass_profile), or formed at the voxel from second moments (one_pass, about the
/// volume-weighted mean). One channel.
MomentPtr fluctuation_moment(const Fluctuating& f, const std::string& mode, std::array<bool, 3> homogeneous);

/// The option `homogeneous` and its value as flags.
OptionInfo homogeneous_option();
std::array<bool, 3> homogeneous_axes(const StageSettings& settings, const std::string& stage);

}  // namespace grainvdb
