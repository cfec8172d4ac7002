#pragma once
/// Cuts fields down to a region.
#include "grainvdb/lattice.hpp"
#include "grainvdb/region.hpp"
#include "pipeline/derive_fields.hpp"

namespace grainvdb {

DerivedFields clip_fields(const DerivedFields& all, const Region& region, const Lattice& lattice);

}  // namespace grainvdb
