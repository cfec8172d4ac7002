#pragma once
/// Parameters of the spot model in print (Rycroft, Wong and Bazant 2010), in diameters d and √(d/g).
#include "spot/spot_model.hpp"

namespace grainvdb::spot {

/// Particles are relaxed after every step.
inline SpotParameters published_spots() {
  SpotParameters p;
  p.radius = 2.6;
  p.influence = 399;
  p.step = {0.676, 0.676, 0.1};
  p.hop_rate = 28;
  p.insertion_rate = 375;
  p.entry = SpotParameters::Entry::spread;
  p.wall_distance = 1;
  p.relaxation.radius = 3.6;
  return p;
}

}  // namespace grainvdb::spot
