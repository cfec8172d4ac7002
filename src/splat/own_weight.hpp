#pragma once
/// How much particles weigh in the means that are sampled at themselves.
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "splat/sample.hpp"

namespace grainvdb {

/// Σ_β (δ_αβ - w_αβ)² for every particle α, w_αβ the share of particle β in the mean that sample_trilinear gives at α:
/// with q independent of each other and of variance 1, the variance of q_α - q̃(x_α). The share of a particle is
/// w_αβ = Σ_n t_n weight_β W(x_n - x_β)/total(x_n) over the eight voxels n around x_α with the trilinear weights t_n;
/// `total` is the sum of weight W over the particles, in one channel of the blocks. Exact to 1e-5: the sums over β are
/// formed in single precision, one voxel's share in double. Images of a particle count as different ones. Where
/// `wanted` is not empty, those of particles with 0 there are left 0. Throws std::logic_error where sample_trilinear
/// does, or is NaN there, as `outside` says.
std::vector<double> deviation_factors(const Lattice& lattice, const LucyKernel& kernel, const Columns3& position,
                                      std::span<const double> weight, const LeafBlocks& total, int channel,
                                      Outside outside = Outside::refuse, std::span<const std::uint8_t> wanted = {});

}  // namespace grainvdb
