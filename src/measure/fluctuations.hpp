#pragma once
/// What remains of velocities or displacements when a mean motion is taken off.
#include <string>

#include "grainvdb/frame.hpp"
#include "grainvdb/options.hpp"

namespace grainvdb {

/// The mean motion that is taken off, the same for velocities and displacements:
/// none: nothing, where there is no mean motion by symmetry; mean: that of all grains; linear: the least-squares fit
/// u₀ + L x to all, as in the boxes of the talks; layers: the mean of each layer of a thickness [length] across an
/// axis.
struct MeanMotion {
  enum class Kind { none, mean, linear, layers };
  Kind kind = Kind::mean;
  std::size_t axis = 2;
  double thickness = 0;
};

/// `value` less the mean motion, for grains at `position`.
Columns3 fluctuations(const MeanMotion& motion, const Columns3& position, const Columns3& value);

/// The declarations of `about`, `axis` and `layer`.
std::vector<OptionInfo> mean_motion_options();
/// `diameter` [length] is that of a layer where the options give none.
MeanMotion mean_motion(const OptionValues& options, double diameter);

}  // namespace grainvdb
