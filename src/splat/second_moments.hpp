#pragma once
/// The splat of SecondMoments.
#include <cstddef>
#include <span>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/topology.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// Hands over the channels of SecondMoments, `q` laid out [point][4]: w > 0 and w v. The sums of a leaf are formed in
/// single precision about the middle of the leaf and the mean velocity of the particles in its reach, then moved to the
/// voxels and to v = 0 in double: central moments are none the worse for it.
void splat_second_moments(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, const LeafConsumer& consume);

}  // namespace grainvdb
