#include "splat/second_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "grainvdb/topology.hpp"
#include "splat/fast_leaf.hpp"
#include "splat/records.hpp"

namespace grainvdb {
namespace {

using SM = SecondMoments;
constexpr std::array<int, 4> factor_weights{-1, 0, 0, 0};  // of w, w v

/// Records of w and of w times the products of v' and r, with r from the middle of the leaf in units of the cutoff and
/// v' from the mean of the candidates.
class ProductRecords final : public RecordSource {
 public:
  ProductRecords(const Buckets& buckets, std::span<const double> q, double cutoff)
      : factors_(buckets, q, factor_weights) {
    const double w = factors_.scale(0);
    scale_[SM::weight] = w;
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = factors_.scale(1 + i) / w;
      scale_[SM::velocity + i] = w * v;
      scale_[SM::place + i] = w * cutoff;
      for (std::size_t j = 0; j < 3; ++j) {
        scale_[SM::velocity_square + SM::pair(i, j)] = w * v * (factors_.scale(1 + j) / w);
        scale_[SM::velocity_place + 3 * i + j] = w * v * cutoff;
        scale_[SM::place_square + SM::pair(i, j)] = w * cutoff * cutoff;
      }
    }
  }

  std::size_t channels() const override { return SM::channels; }
  std::size_t stride() const override { return SM::channels; }
  double scale(std::size_t channel) const override { return scale_[channel]; }
  std::size_t weight(std::size_t channel) const override { return channel; }

  void gather(const Coord& leaf, const LeafCandidates& candidates, LeafRecords& out) const override {
    LeafRecords& factors = factors_of_leaf_.local();
    factors_.gather(leaf, candidates, factors);
    const std::array<float, 3> mean = mean_of(factors, candidates.count);
    for (std::size_t i = 0; i < 3; ++i)
      out.about[i] =
          factors.reference[1 + i] + static_cast<double>(mean[i]) * factors_.scale(1 + i) / factors_.scale(0);

    out.reference.assign(SM::channels, 0.0);
    out.largest.assign(SM::channels, 0.0F);
    float* to = out.values.room(candidates.count * SM::channels);
    for (std::size_t k = 0; k < candidates.count; ++k, to += SM::channels) {
      const float* from = factors.values.data() + k * factors_.stride();
      const float w = from[0];
      const std::array<float, 3> r{candidates.x[k], candidates.y[k], candidates.z[k]};
      std::array<float, 3> v{};
      for (std::size_t i = 0; i < 3; ++i) v[i] = from[1 + i] / w - mean[i];
      to[SM::weight] = w;
      for (std::size_t i = 0; i < 3; ++i) {
        to[SM::velocity + i] = w * v[i];
        to[SM::place + i] = w * r[i];
        for (std::size_t j = 0; j < 3; ++j) to[SM::velocity_place + 3 * i + j] = w * v[i] * r[j];
        for (std::size_t j = i; j < 3; ++j) {
          to[SM::velocity_square + SM::pair(i, j)] = w * v[i] * v[j];
          to[SM::place_square + SM::pair(i, j)] = w * r[i] * r[j];
        }
      }
      for (std::size_t c = 0; c < SM::channels; ++c) out.largest[c] = std::max(out.largest[c], std::abs(to[c]));
    }
  }

 private:
  /// The mean of v over the candidates, weighed by w, in units of the scales.
  std::array<float, 3> mean_of(const LeafRecords& factors, std::size_t count) const {
    double weight = 0;
    std::array<double, 3> sum{};
    for (std::size_t k = 0; k < count; ++k) {
      const float* from = factors.values.data() + k * factors_.stride();
      weight += static_cast<double>(from[0]);
      for (std::size_t i = 0; i < 3; ++i) sum[i] += static_cast<double>(from[1 + i]);
    }
    std::array<float, 3> mean{};
    for (std::size_t i = 0; i < 3; ++i) mean[i] = static_cast<float>(sum[i] / weight);
    return mean;
  }

  Records factors_;
  std::array<double, SM::channels> scale_{};
  mutable tbb::enumerable_thread_specific<LeafRecords> factors_of_leaf_;
};

/// Moves the sums at one voxel from places about the leaf's middle to places about s from there, then from velocities
/// about a to velocities about 0.
void move_origins(double* sums, std::size_t at, const Vec3& s, const Vec3& a) {
  const auto sum = [&](std::size_t channel) -> double& { return sums[channel * leaf_size + at]; };
  const double w = sum(SM::weight);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      sum(SM::place_square + SM::pair(i, j)) -= s[i] * sum(SM::place + j) + s[j] * sum(SM::place + i) - s[i] * s[j] * w;
  for (std::size_t j = 0; j < 3; ++j) sum(SM::place + j) -= s[j] * w;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      sum(SM::velocity_place + 3 * i + j) += a[i] * sum(SM::place + j) - s[j] * sum(SM::velocity + i);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      sum(SM::velocity_square + SM::pair(i, j)) +=
          a[i] * sum(SM::velocity + j) + a[j] * sum(SM::velocity + i) + a[i] * a[j] * w;
  for (std::size_t i = 0; i < 3; ++i) sum(SM::velocity + i) += a[i] * w;
}

/// A voxel of a leaf from the leaf's middle.
Vec3 from_middle(int offset, double voxel) {
  const Coord c = voxel_at({0, 0, 0}, offset);
  constexpr double middle = 0.5 * (leaf_edge - 1);
  return {voxel * (c.x - middle), voxel * (c.y - middle), voxel * (c.z - middle)};
}

}  // namespace

void splat_second_moments(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                          const Topology& topology, std::span<const double> q, const LeafConsumer& consume) {
  const ProductRecords records(buckets, q, kernel.cutoff());
  const FastLeafSplat splat(lattice, kernel, buckets, records);
  tbb::enumerable_thread_specific<LeafWork> works;
  parallel_for(topology.leaf_count(), [&](std::size_t leaf) {
    LeafWork& work = works.local();
    splat.run(topology.origin(leaf), topology.mask(leaf), work);
    topology.mask(leaf).for_each([&](int offset) {
      move_origins(work.values.data(), static_cast<std::size_t>(offset), from_middle(offset, lattice.voxel()),
                   work.records.about);
    });
    consume(leaf, work.values.data());
  });
}

}  // namespace grainvdb
