#include "splat/accumulate.hpp"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "grainvdb/moment.hpp"
#include "splat/bricks.hpp"
#include "splat/candidates.hpp"
#include "splat/gather.hpp"
#include "splat/records.hpp"
#include "splat/second_moments.hpp"
#include "splat/splat.hpp"

namespace grainvdb {
namespace {

/// Brick sums and nothing else.
class SingleSplat {
 public:
  SingleSplat(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const RecordSource& records)
      : buckets_(buckets),
        records_(records),
        cutoff_(kernel.cutoff() / lattice.voxel()),
        peak_(kernel.value(0) / summed_part) {}

  struct Work {
    LeafCandidates candidates;
    LeafRecords records;
    LeafSums sums;
    std::vector<double> values;  // [channel][offset]
  };

  const double* run(const Coord& origin, const LeafMask& active, Work& work) const {
    const std::size_t channels = records_.channels();
    gather_candidates(buckets_, origin, cutoff_, work.candidates);
    work.values.assign(channels * leaf_size, 0.0);
    if (work.candidates.count == 0) return work.values.data();
    records_.gather(origin, work.candidates, work.records);
    splat_leaf({&work.candidates, work.records.values.data(), records_.stride(), static_cast<int>(channels),
                static_cast<float>(1 / cutoff_)},
               active, work.sums);
    for (std::size_t c = 0; c < channels; ++c)
      scale_sums(work.sums.sums, {.sum = static_cast<int>(1 + c), .unit = peak_ * records_.scale(c)}, active,
                 work.values.data() + c * leaf_size);
    return work.values.data();
  }

 private:
  const Buckets& buckets_;
  const RecordSource& records_;
  double cutoff_;  // in voxels
  double peak_;
};

void splat_in_single(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const Topology& topology,
                     const RecordSource& records, const LeafConsumer& consume) {
  const SingleSplat splat(lattice, kernel, buckets, records);
  tbb::enumerable_thread_specific<SingleSplat::Work> work;
  parallel_for(topology.leaf_count(), [&](std::size_t leaf) {
    consume(leaf, splat.run(topology.origin(leaf), topology.mask(leaf), work.local()));
  });
}

void splat_in_single(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const Topology& topology,
                     std::span<const double> q, std::size_t channels, const LeafConsumer& consume) {
  const std::vector<int> unweighed(channels, -1);  // no references
  splat_in_single(lattice, kernel, buckets, topology, Records(buckets, q, unweighed), consume);
}

/// The channels of SecondMoments of one particle, from its w and w v, at r from the voxel.
void set_products(const double* value, const Vec3& r, double* product) {
  using SM = SecondMoments;
  const double w = value[0];
  product[SM::weight] = w;
  for (std::size_t i = 0; i < 3; ++i) {
    const double wv = value[1 + i];
    product[SM::velocity + i] = wv;
    product[SM::place + i] = w * r[i];
    for (std::size_t j = 0; j < 3; ++j) product[SM::velocity_place + 3 * i + j] = wv * r[j];
    for (std::size_t j = i; j < 3; ++j) {
      product[SM::velocity_square + SM::pair(i, j)] = w > 0 ? wv * value[1 + j] / w : 0;
      product[SM::place_square + SM::pair(i, j)] = w * r[i] * r[j];
    }
  }
}

/// Adds the terms one by one, in numbers of the given precision.
template <class Real>
void add_second_moments(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                        const Topology& topology, std::span<const double> q, const LeafConsumer& consume) {
  constexpr std::size_t channels = SecondMoments::channels;
  const double h = lattice.voxel();
  const double reach = kernel.cutoff() / h;
  gather_leaves(
      lattice, buckets, reach, topology, channels,
      [&](std::size_t entry, const LeafWindow& window, double* sums) {
        std::array<double, channels> product{};
        for_each_voxel(window, entry_index(buckets, entry), reach, [&](int offset, const Vec3& d) {
          const Vec3 r{-d[0] * h, -d[1] * h, -d[2] * h};
          const double weight = kernel.value(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          set_products(q.data() + 4 * buckets.point[entry], r, product.data());
          double* sum = sums + static_cast<std::size_t>(offset) * channels;
          for (std::size_t c = 0; c < channels; ++c)
            sum[c] = static_cast<double>(static_cast<Real>(sum[c]) + static_cast<Real>(product[c] * weight));
        });
      },
      consume);
}

}  // namespace

void accumulate_particles(Accumulation how, const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, std::span<const int> weight_of,
                          const LeafConsumer& consume) {
  switch (how) {
    case Accumulation::shifted:
      return splat_particles_fast(lattice, kernel, buckets, topology, q, weight_of, consume);
    case Accumulation::single:
      return splat_in_single(lattice, kernel, buckets, topology, q, weight_of.size(), consume);
    case Accumulation::twofold:
      return splat_particles(lattice, kernel, buckets, topology, q, static_cast<int>(weight_of.size()), consume);
  }
}

void accumulate_second_moments(Accumulation how, const Lattice& lattice, const LucyKernel& kernel,
                               const Buckets& buckets, const Topology& topology, std::span<const double> q,
                               const LeafConsumer& consume) {
  switch (how) {
    case Accumulation::shifted:
      return splat_second_moments(lattice, kernel, buckets, topology, q, consume);
    case Accumulation::single:
      return add_second_moments<float>(lattice, kernel, buckets, topology, q, consume);
    case Accumulation::twofold:
      return add_second_moments<double>(lattice, kernel, buckets, topology, q, consume);
  }
}

LeafBuffers accumulate_buffered(Accumulation how, const Lattice& lattice, const LucyKernel& kernel,
                                const Buckets& buckets, std::shared_ptr<const Topology> topology,
                                std::span<const double> q, int channels) {
  if (how != Accumulation::single) return splat_particles(lattice, kernel, buckets, std::move(topology), q, channels);
  return kept_in_buffers(std::move(topology), channels, [&](const Topology& leaves, const LeafConsumer& consume) {
    splat_in_single(lattice, kernel, buckets, leaves, q, static_cast<std::size_t>(channels), consume);
  });
}

}  // namespace grainvdb
