#pragma once
/// The moments that fields share. Each function returns a fresh description; the plan merges those of equal name.
#include <vector>

#include "grainvdb/moment.hpp"
#include "grainvdb/options.hpp"

namespace grainvdb {

/// Σ V W, the packing fraction (6); one channel.
MomentPtr volume_moment();
/// Σ m W, the density; one channel.
MomentPtr mass_moment();
/// Σ V d W, for (A19); one channel.
MomentPtr volume_diameter_moment();
/// Σ V ω W, for (A16); three channels.
MomentPtr volume_spin_moment();

/// Σ w v W and Σ w W with w = V, or m where the option velocity.weighting is `mass` (7); three channels and one.
MomentPtr velocity_numerator(const StageSettings& settings);
MomentPtr velocity_denominator(const StageSettings& settings);

/// Σ V ω_i ∂_j W (nine channels, 3 i + j) and Σ V ∂_j W (three channels).
MomentPtr volume_spin_gradient();
MomentPtr volume_gradient();

/// The same for velocity_numerator and velocity_denominator.
MomentPtr velocity_numerator_gradient(const StageSettings& settings);
MomentPtr velocity_denominator_gradient(const StageSettings& settings);

}  // namespace grainvdb
