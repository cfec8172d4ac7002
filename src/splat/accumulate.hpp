#pragma once
/// The sums over particles, added up as the pipeline wants it.
#include <span>

#include "bin/buckets.hpp"
#include "grainvdb/accumulation.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/topology.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// As splat_particles_fast.
void accumulate_particles(Accumulation how, const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, std::span<const int> weight_of,
                          const LeafConsumer& consume);

/// As splat_second_moments.
void accumulate_second_moments(Accumulation how, const Lattice& lattice, const LucyKernel& kernel,
                               const Buckets& buckets, const Topology& topology, std::span<const double> q,
                               const LeafConsumer& consume);

/// Of moments that are added up in double precision unless it is Accumulation::single. As splat_particles.
LeafBuffers accumulate_buffered(Accumulation how, const Lattice& lattice, const LucyKernel& kernel,
                                const Buckets& buckets, std::shared_ptr<const Topology> topology,
                                std::span<const double> q, int channels);

}  // namespace grainvdb
