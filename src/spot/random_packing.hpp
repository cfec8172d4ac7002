#pragma once
/// Random packings for tests and starts without a dump.
#include <cstdint>

#include "grainvdb/box.hpp"
#include "spot/particle_store.hpp"

namespace grainvdb::spot {

/// Spheres at independent places between `lo` and `hi`, as many as give that packing fraction, ids from 1. Along axes
/// that are not periodic centres keep half a diameter from the ends. They overlap freely.
Packing poisson_packing(const Box& box, double phi, double diameter, std::uint64_t seed);

/// As above, with the overlaps removed: all spheres are pushed apart in turn until none overlaps by more than 1e-3
/// diameters. Up to φ ≈ 0.6; throws LimitError where that is not reached within 20,000 passes, as near random close
/// packing (0.64).
Packing random_packing(const Box& box, double phi, double diameter, std::uint64_t seed);

}  // namespace grainvdb::spot
