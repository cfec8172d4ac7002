#pragma once
/// Mean squared deviation of a particle vector from its local mean: granular temperature (of velocities) and rotational
/// fluctuation (of angular velocities) are formed alike.
#include <string>

#include "grainvdb/stage.hpp"

namespace grainvdb {

/// Which vector fluctuates, and about which mean.
struct Fluctuating {
  std::string stage;                                    ///< the name of the field
  std::string label;                                    ///< for the names of moments
  Column column;                                        ///< to be read
  Columns3 Particles::*vector;                          ///< q_α
  MomentPtr (*mean_numerator)(const StageSettings&);    ///< Σ w q W, three channels
  MomentPtr (*mean_denominator)(const StageSettings&);  ///< Σ w W
  std::string gradient;                                 ///< the field with the gradient of the mean
};

/// Gives the stage its options, needs and computation: Σ V |q_α - q̃(x_α)|² W / Σ V W by the mode of physics section 3
/// that is asked for.
///
/// self_weight: a mean of few particles follows each of them, and what is left of their deviations is too small. With q
/// independent of each other and of equal variance T₀, the deviation of α from the mean at itself has the variance
/// T₀ Σ_β (δ_αβ - w_αβ)², w_αβ the share of β in that mean, known exactly (FrameView::deviation_factors); in a large
/// uniform packing it is T₀ (1 - 2a + b) of physics section 3. About the mean at a voxel, the variance of those around
/// it is T₀ (1 - Σ w_β²). The correction divides by Σ V W times that factor in place of Σ V W, so that T₀ comes out
/// whatever the packing, the sizes and the distance to a surface are.
///
/// one_pass_corrected takes off the part (c²/12) L:L that a linear mean flow has by itself, before it divides.
void set_fluctuation(Stage& stage, const Fluctuating& f);

}  // namespace grainvdb
