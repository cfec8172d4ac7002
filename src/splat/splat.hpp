#pragma once
/// The splat: a bucketed frame in, channel leaf buffers out. Every leaf is written by one task that adds its terms in a
/// fixed order, so the result has the same bytes for any number of threads.
#include <cstddef>
#include <memory>
#include <span>

#include "bin/buckets.hpp"
#include "grainvdb/accumulation.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/region.hpp"
#include "grainvdb/sparse_field.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// The voxels that the kernel reaches from any entry: exactly those where W > 0. Of the leaves that are wanted, if not
/// all are; the buckets must then be complete for those.
std::shared_ptr<const Topology> particle_topology(const Lattice& lattice, const LucyKernel& kernel,
                                                  const Buckets& buckets, const Region* wanted = nullptr);

/// Σ_α q_α W(x - x_α) at every active voxel, in double precision. `q` is laid out [point][channel].
LeafBuffers splat_particles(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                            std::shared_ptr<const Topology> topology, std::span<const double> q, int channels);

/// The same sums, handed over leaf by leaf.
void splat_particles(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const Topology& topology,
                     std::span<const double> q, int channels, const LeafConsumer& consume);

/// The same sums by the vectorised kernel, in single precision: relative to the sum of |terms| they are exact to 1e-5
/// at every voxel, those on the rim of the supports included. `weight_of[c]` is the channel that weighs channel c, or
/// -1: Σ w q W is then summed about a local reference of q, so that the mean of q loses nothing however small its
/// variation is.
LeafBuffers splat_particles_fast(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                 std::shared_ptr<const Topology> topology, std::span<const double> q,
                                 std::span<const int> weight_of);

/// Rounds values to single precision, as grids hold them; `count` is a multiple of 8.
void narrow(const double* from, std::size_t count, float* to);

/// The same sums, handed over leaf by leaf while they are in the cache, with no buffer for all of them.
void splat_particles_fast(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, std::span<const int> weight_of,
                          const LeafConsumer& consume);

/// Σ_α q_α W(x - x_α)², in double precision.
LeafBuffers splat_particle_squares(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                   std::shared_ptr<const Topology> topology, std::span<const double> q, int channels);

/// The same sums in a field on grids, one component per channel, 0 where inactive.
SparseField splat_particles_field(FieldMeta meta, const Lattice& lattice, const LucyKernel& kernel,
                                  const Buckets& buckets, std::shared_ptr<const Topology> topology,
                                  std::span<const double> q, std::span<const int> weight_of);

/// Σ_α q_α ∂_j W(x - x_α): channel 3 v + j for value v and axis j. `q` is laid out [point][value].
LeafBuffers splat_particle_gradients(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                     std::shared_ptr<const Topology> topology, std::span<const double> q, int values);

/// Σ over half branches of q ∫₀¹ W(x - x_α + s a) ds, on the voxels within one cutoff of any branch (where the integral
/// is > 0), whatever the method. `q` is laid out [branch][channel]. Method::exact sums in double precision; the rules
/// are summed by vectors in single precision, which is exact to 1e-5 of the sum of |terms| at every voxel.
LeafBuffers splat_contacts(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method);

/// The same in two steps, so that the sums can be handed over leaf by leaf.
class ContactSplat {
 public:
  /// The branches and values must outlive the splat. Only leaves that are wanted are summed; nullptr: all. Throws
  /// std::invalid_argument when q has another size.
  ContactSplat(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
               std::span<const double> q, int channels, LineIntegral method, const Region* wanted = nullptr);
  /// The same at the voxels of `onto`, among which are those that the branches reach in its leaves.
  ContactSplat(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
               std::span<const double> q, int channels, LineIntegral method, const Region* wanted,
               std::shared_ptr<const Topology> onto);
  ~ContactSplat();

  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  /// Without branches nothing is handed over. Accumulation::twofold adds up the terms of any method in double.
  void sums(const LeafConsumer& consume, Accumulation how = Accumulation::shifted) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;  // nothing without branches
  std::shared_ptr<const Topology> topology_;
  bool has_more_voxels_ = true;  // than the branches reach
};

}  // namespace grainvdb
