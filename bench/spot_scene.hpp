#pragma once
/// The silo of the published spot runs, and what may go wrong in a run.
#include <cstddef>
#include <cstdint>

#include "sizes.hpp"
#include "spot/spot_model.hpp"

namespace grainvdb::bench {

struct SpotScene {
  spot::Container container;
  spot::Packing packing;
  spot::SpotParameters parameters;
};

/// The published silo, 50 d wide and 8 d deep, with an orifice of 8 d and 55,000 particles at the start, or a part of
/// it. The published parameters; relaxed or not.
SpotScene make_silo(const Sizes& sizes, bool relaxed);

/// A run must never come to any of these.
struct Breakdowns {
  std::uint64_t outside = 0;    ///< particles or spots beyond a wall or the floor
  std::uint64_t overlaps = 0;   ///< pairs nearer than half a diameter
  std::uint64_t unlisted = 0;   ///< pairs that overlap and are not in each other's list
  std::uint64_t lost = 0;       ///< ids that are neither in the silo nor have left it, or are in both, or twice
  std::uint64_t uncounted = 0;  ///< spots that are there without having entered, or the reverse
  double worst_overlap = 0;     ///< in diameters, of all pairs
  double badness = 0;           ///< Σ δ²/d² per particle, of the last call

  std::uint64_t all() const { return outside + overlaps + unlisted + lost + uncounted; }
};

/// Looks for them among all particles, spots and pairs of a relaxed run, and adds what it finds.
void look_for_breakdowns(const SpotScene& scene, const spot::SpotModel& model, Breakdowns& found);

}  // namespace grainvdb::bench
