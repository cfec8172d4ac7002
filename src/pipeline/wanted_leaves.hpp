#pragma once
/// From a region to the leaves that each moment must be computed on, so that the fields in the region come out as they
/// would without it.
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/region.hpp"

namespace grainvdb {

/// The leaves of the stored period that a moment with this halo needs. A leaf comes out the same, to the last bit, when
/// all cells that its kernels reach are complete; so values at particles are needed in whole cells.
Region wanted_leaves(const Region& region, const Halo& halo, const Lattice& lattice, const LucyKernel& kernel);

}  // namespace grainvdb
