#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "splat/fast_leaf.hpp"
#include "splat/records.hpp"
#include "splat/splat.hpp"

namespace grainvdb {

void splat_particles_fast(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, std::span<const int> weight_of,
                          const LeafConsumer& consume) {
  const Records records(buckets, q, weight_of);
  const FastLeafSplat splat(lattice, kernel, buckets, records);
  tbb::enumerable_thread_specific<LeafWork> work;
  parallel_for(topology.leaf_count(), [&](std::size_t leaf) {
    consume(leaf, splat.run(topology.origin(leaf), topology.mask(leaf), work.local()));
  });
}

SparseField splat_particles_field(FieldMeta meta, const Lattice& lattice, const LucyKernel& kernel,
                                  const Buckets& buckets, std::shared_ptr<const Topology> topology,
                                  std::span<const double> q, std::span<const int> weight_of) {
  const Records records(buckets, q, weight_of);
  const FastLeafSplat splat(lattice, kernel, buckets, records);
  meta.components = static_cast<int>(records.channels());
  SparseField field = SparseField::unset(std::move(meta), std::move(topology), lattice);
  tbb::enumerable_thread_specific<LeafWork> work;
  parallel_for(field.topology()->leaf_count(), [&](std::size_t leaf) {
    splat.run(field.topology()->origin(leaf), field.topology()->mask(leaf), work.local(), field.components_of(leaf));
  });
  return field;
}

LeafBuffers splat_particles_fast(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                 std::shared_ptr<const Topology> topology, std::span<const double> q,
                                 std::span<const int> weight_of) {
  return kept_in_buffers(std::move(topology), static_cast<int>(weight_of.size()),
                         [&](const Topology& leaves, const LeafConsumer& consume) {
                           splat_particles_fast(lattice, kernel, buckets, leaves, q, weight_of, consume);
                         });
}

}  // namespace grainvdb
