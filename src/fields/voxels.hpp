#pragma once
/// Loops that turn averaged moments into fields.
#include <cstddef>

#include "grainvdb/stage.hpp"

namespace grainvdb {

/// out[c] = channel c of the moment, at every active voxel.
void write_moment(const StageInput& in, const Moment& moment, SparseField& out);

/// out[c] = channel c of `numerator` over the single channel of `denominator`; undefined (NaN, no_material) where the
/// denominator is zero.
void write_ratio(const StageInput& in, const Moment& numerator, const Moment& denominator, SparseField& out);

}  // namespace grainvdb
