#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "splat/brick_scratch.hpp"
#include "splat/bricks.hpp"
#include "splat/gather.hpp"
#include "splat/splat.hpp"

namespace grainvdb {
namespace {

// Coordinates in single precision move the rim of a support by δ = 2e-7 c, which changes W by a factor 3 δ/(1-r): more
// than 1e-5 for the terms with 1-r < 0.06, each of which is less than 1e-3 W(0). They matter only where a sum has
// little else, and there the voxel is summed again in double:

/// where the sum of W/W(0) is less than this (the outermost voxels of the material),
constexpr double rim = 0.2;
/// and where the sum of a channel is less than this part of W(0) times the largest |q| of the leaf (its larger values
/// are far away).
constexpr double faint = 3e-3;

/// One leaf's candidates and sums, reused from leaf to leaf.
struct LeafWork {
  std::vector<std::size_t> entries;
  hwy::AlignedFreeUniquePtr<float[]> x, y, z;
  std::vector<float> q;
  std::vector<double> reference;
  std::vector<float> least;  // below which a channel's sum is faint
  std::vector<float> sums;
  std::vector<std::size_t> again;  // channels of a voxel to be summed in double
  std::size_t capacity = 0;
  BrickScratch scratch;

  void reserve(std::size_t candidates) {
    const std::size_t n = candidates + 32;  // vectors are loaded past the end
    if (n <= capacity) return;
    capacity = n + n / 2;
    x = hwy::AllocateAligned<float>(capacity);
    y = hwy::AllocateAligned<float>(capacity);
    z = hwy::AllocateAligned<float>(capacity);
  }
};

class FastSplat {
 public:
  FastSplat(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, std::span<const double> q,
            std::span<const int> weight_of)
      : lattice_(lattice),
        kernel_(kernel),
        buckets_(buckets),
        q_(q),
        weight_of_(weight_of.begin(), weight_of.end()),
        channels_(weight_of.size()),
        scale_(weight_of.size(), 0.0),
        cutoff_(kernel.cutoff() / lattice.voxel()) {
    for (std::size_t n = 0; n < q.size(); ++n) {
      double& scale = scale_[n % channels_];
      scale = std::max(scale, std::abs(q[n]));
    }
    for (double& scale : scale_)
      if (scale == 0) scale = 1;
  }

  void run(std::size_t leaf, LeafBuffers& result, LeafWork& work) const {
    const Topology& topology = *result.topology();
    const Coord origin = topology.origin(leaf);
    collect(origin, work);
    choose_references(work);
    fill_values(work);
    work.sums.resize((channels_ + 1) * leaf_size);
    const std::size_t stride = channels_ + 1;
    splat_leaf({work.x.get(), work.y.get(), work.z.get(), work.q.data(), work.entries.size(), stride,
                static_cast<int>(stride), static_cast<float>(1 / cutoff_)},
               work.scratch, work.sums.data());
    store(topology, leaf, work, result);
  }

 private:
  void collect(const Coord& origin, LeafWork& work) const {
    work.entries.clear();
    const double reach2 = cutoff_ * cutoff_;
    for_each_entry(buckets_, origin, cutoff_, [&](std::size_t e) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a) {
        const double beyond = std::max(std::abs(buckets_.index[a][e] - origin[a] - 3.5) - 3.5, 0.0);
        r2 += beyond * beyond;
      }
      if (r2 < reach2) work.entries.push_back(e);
    });
    work.reserve(work.entries.size());
    for (std::size_t k = 0; k < work.entries.size(); ++k) {
      const std::size_t e = work.entries[k];
      work.x[k] = static_cast<float>((buckets_.index[0][e] - origin.x) / cutoff_);
      work.y[k] = static_cast<float>((buckets_.index[1][e] - origin.y) / cutoff_);
      work.z[k] = static_cast<float>((buckets_.index[2][e] - origin.z) / cutoff_);
    }
  }

  const double* values(std::size_t entry) const { return q_.data() + buckets_.point[entry] * channels_; }

  /// For channels w q: the mean of q over the candidates if all are within half of it, else 0. So |q| is at least half
  /// the reference wherever there is one, and the rounding of w (q - r) stays small against |w q|.
  void choose_references(LeafWork& work) const {
    work.reference.assign(channels_, 0.0);
    for (std::size_t c = 0; c < channels_; ++c) {
      if (weight_of_[c] < 0) continue;
      const auto weight = static_cast<std::size_t>(weight_of_[c]);
      double above = 0;
      double below = 0;
      for (const std::size_t e : work.entries) {
        above += values(e)[c];
        below += values(e)[weight];
      }
      if (!(below > 0)) continue;
      const double mean = above / below;
      const bool close = std::all_of(work.entries.begin(), work.entries.end(), [&](std::size_t e) {
        const double w = values(e)[weight];
        return std::abs(values(e)[c] - mean * w) <= 0.5 * std::abs(mean) * w;
      });
      if (close) work.reference[c] = mean;
    }
  }

  void fill_values(LeafWork& work) const {
    const std::size_t stride = channels_ + 1;
    work.q.resize(work.entries.size() * stride);
    work.least.assign(channels_, 0.0F);
    float* to = work.q.data();
    for (const std::size_t e : work.entries) {
      const double* v = values(e);
      for (std::size_t c = 0; c < channels_; ++c) {
        const double about = weight_of_[c] < 0 ? v[c] : v[c] - work.reference[c] * v[weight_of_[c]];
        to[c] = static_cast<float>(about / scale_[c]);
        work.least[c] = std::max(work.least[c], std::abs(to[c]));
      }
      to[channels_] = 1;
      to += stride;
    }
    // Sums about a reference are small against the reference, whose own sum is right.
    for (std::size_t c = 0; c < channels_; ++c)
      work.least[c] *= work.reference[c] != 0 ? 0.0F : static_cast<float>(faint);
  }

  void store(const Topology& topology, std::size_t leaf, LeafWork& work, LeafBuffers& result) const {
    const double peak = kernel_.value(0);
    const float* plain = work.sums.data() + channels_ * leaf_size;
    for (std::size_t c = 0; c < channels_; ++c) {
      const auto w = weight_of_[c] < 0 ? c : static_cast<std::size_t>(weight_of_[c]);
      const float* sum = work.sums.data() + c * leaf_size;
      const float* weight = work.sums.data() + w * leaf_size;
      const double unit = peak * scale_[c];
      const double reference = peak * scale_[w] * work.reference[c];
      double* to = result.block(leaf, static_cast<int>(c));
      topology.mask(leaf).for_each([&](int v) { to[v] = unit * sum[v] + reference * weight[v]; });
    }
    // Each channel is judged by itself, so that a sum does not depend on which others are asked for.
    topology.mask(leaf).for_each([&](int v) {
      work.again.clear();
      for (std::size_t c = 0; c < channels_; ++c)
        if (plain[v] < rim || std::abs(work.sums[c * leaf_size + static_cast<std::size_t>(v)]) < work.least[c])
          work.again.push_back(c);
      if (!work.again.empty()) sum_in_double(topology.origin(leaf), leaf, v, work, result);
    });
  }

  void sum_in_double(const Coord& origin, std::size_t leaf, int offset, const LeafWork& work,
                     LeafBuffers& result) const {
    const double h = lattice_.voxel();
    const Coord at = voxel_at(origin, offset);
    for (const std::size_t c : work.again) result.block(leaf, static_cast<int>(c))[offset] = 0;
    for (const std::size_t e : work.entries) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = (at[a] - buckets_.index[a][e]) * h;
        r2 += d * d;
      }
      const double w = kernel_.value(r2);
      if (w > 0)
        for (const std::size_t c : work.again) result.block(leaf, static_cast<int>(c))[offset] += values(e)[c] * w;
    }
  }

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const Buckets& buckets_;
  std::span<const double> q_;
  std::vector<int> weight_of_;
  std::size_t channels_;
  std::vector<double> scale_;  ///< largest |q| of each channel: keeps single precision in its range whatever the units
  double cutoff_;              ///< in voxels
};

}  // namespace

LeafBuffers splat_particles_fast(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                 std::shared_ptr<const Topology> topology, std::span<const double> q,
                                 std::span<const int> weight_of) {
  LeafBuffers result(std::move(topology), static_cast<int>(weight_of.size()));
  const FastSplat splat(lattice, kernel, buckets, q, weight_of);
  tbb::enumerable_thread_specific<LeafWork> work;
  parallel_for(result.topology()->leaf_count(), [&](std::size_t leaf) { splat.run(leaf, result, work.local()); });
  return result;
}

}  // namespace grainvdb
