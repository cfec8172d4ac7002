#include "splat/splat.hpp"

#include <utility>

#include "splat/gather.hpp"

namespace grainvdb {
namespace {

double squared(const Vec3& d) {
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

// Squared distance [length²] of a voxel from a particle, d in voxels. Topology and sums must see the same bits.
double distance2(const Vec3& d, double h) {
  return squared({d[0] * h, d[1] * h, d[2] * h});
}

// sum_c += q_c w for the channels of one voxel.
void add_scaled(double* sum, const double* q, double w, std::size_t channels) {
  for (std::size_t c = 0; c < channels; ++c) sum[c] += q[c] * w;
}

// Adds the terms of one entry of Σ_α q_α weight(|x - x_α|²), for the gather.
template <class Weight>
auto weighed_terms(double h, double cutoff, const Buckets& buckets, std::span<const double> q, int channels,
                   const Weight& weight) {
  return [&buckets, &weight, q, h, reach = cutoff / h, width = static_cast<std::size_t>(channels)](
             std::size_t entry, const LeafWindow& window, double* sums) {
    const double* values = q.data() + buckets.point[entry] * width;
    for_each_voxel(window, entry_index(buckets, entry), reach, [&](int offset, const Vec3& d) {
      add_scaled(sums + static_cast<std::size_t>(offset) * width, values, weight(distance2(d, h)), width);
    });
  };
}

template <class Weight>
LeafBuffers splat_weighed(const Lattice& lattice, double cutoff, const Buckets& buckets,
                          std::shared_ptr<const Topology> topology, std::span<const double> q, int channels,
                          const Weight& weight) {
  return gather(lattice, buckets, cutoff / lattice.voxel(), std::move(topology), channels,
                weighed_terms(lattice.voxel(), cutoff, buckets, q, channels, weight));
}

}  // namespace

LeafBuffers splat_particles(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                            std::shared_ptr<const Topology> topology, std::span<const double> q, int channels) {
  return splat_weighed(lattice, kernel.cutoff(), buckets, std::move(topology), q, channels,
                       [&](double r2) { return kernel.value(r2); });
}

void splat_particles(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const Topology& topology,
                     std::span<const double> q, int channels, const LeafConsumer& consume) {
  const auto weight = [&](double r2) { return kernel.value(r2); };
  gather_leaves(lattice, buckets, kernel.cutoff() / lattice.voxel(), topology, static_cast<std::size_t>(channels),
                weighed_terms(lattice.voxel(), kernel.cutoff(), buckets, q, channels, weight), consume);
}

LeafBuffers splat_particle_squares(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                   std::shared_ptr<const Topology> topology, std::span<const double> q, int channels) {
  return splat_weighed(lattice, kernel.cutoff(), buckets, std::move(topology), q, channels, [&](double r2) {
    const double w = kernel.value(r2);
    return w * w;
  });
}

LeafBuffers splat_particle_gradients(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                     std::shared_ptr<const Topology> topology, std::span<const double> q, int values) {
  const double h = lattice.voxel();
  const double reach = kernel.cutoff() / h;
  const auto count = static_cast<std::size_t>(values);
  return gather(lattice, buckets, reach, std::move(topology), 3 * values,
                [&](std::size_t entry, const LeafWindow& window, double* sums) {
                  const double* value = q.data() + buckets.point[entry] * count;
                  for_each_voxel(window, entry_index(buckets, entry), reach, [&](int offset, const Vec3& d) {
                    const double f = kernel.gradient_factor(distance2(d, h)) * h;
                    double* sum = sums + static_cast<std::size_t>(offset) * 3 * count;
                    for (std::size_t v = 0; v < count; ++v)
                      for (std::size_t j = 0; j < 3; ++j) sum[3 * v + j] += value[v] * (f * d[j]);
                  });
                });
}

}  // namespace grainvdb
