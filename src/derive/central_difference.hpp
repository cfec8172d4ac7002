#pragma once
/// Derivatives of a scalar or vector field by differences between voxels.
#include "grainvdb/lattice.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// out = ∂u_i/∂x_j at component 3 i + j, in double from the float values of `u` (one component or three) on out's
/// topology, with periodic wrap. A voxel is defined when it is active and no component of u is NaN there. Per axis:
/// - both neighbours defined: (u₊ - u₋)/(2h), second order;
/// - one of them: s [4 (u₁ - u₀) - (u₂ - u₀)]/(2h) towards that side s = ±1, second order, or s (u₁ - u₀)/h where the
///   next but one is undefined; Reason::one_sided_gradient;
/// - none: the three derivatives along that axis are NaN; the reason `none`.
/// All formulas are differences of values, so a constant u gives exactly 0. NaN without a reason where u itself is NaN.
void central_difference(const Lattice& lattice, const SparseField& u, SparseField& out, Mask& mask, Reason none);

}  // namespace grainvdb
