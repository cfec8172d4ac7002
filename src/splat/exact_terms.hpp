#pragma once
/// Sums in double precision at single voxels, for those where single precision is not enough.
#include <cstddef>
#include <cstdint>
#include <span>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/topology.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"

namespace grainvdb {

/// What a voxel sees of its candidates.
struct ExactTerms {
  Grow<double> w;         ///< W at their distances
  Grow<std::int32_t> of;  ///< their places in the leaf's list
  std::size_t count = 0;
};

/// Finds the terms of a voxel among candidates that were chosen for a brick around it, places in the leaf's list, in
/// their order. `voxel` is its offset in the leaf; positions are taken in double precision.
void find_terms(const Buckets& buckets, const LeafCandidates& candidates, std::span<const std::int32_t> chosen,
                const Coord& leaf, int voxel, double h, const LucyKernel& kernel, ExactTerms& out);

/// sums[channel] = Σ w values[candidate][channel]; `sums` has `stride` elements.
void sum_terms(const ExactTerms& terms, const float* values, std::size_t stride, double* sums);

}  // namespace grainvdb
