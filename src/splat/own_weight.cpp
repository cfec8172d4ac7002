#include "splat/own_weight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "bin/buckets.hpp"
#include "splat/candidates.hpp"
#include "splat/leaf_finder.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/own_weight.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

#ifndef GRAINVDB_SPLAT_OWN_WEIGHT
#define GRAINVDB_SPLAT_OWN_WEIGHT
namespace grainvdb {

// A voxel beside a particle, and t_n/total(x_n) of it.
struct Corner {
  float x, y, z, share;
};

// Particles near one of them, their positions in units of `per_cutoff` cutoffs.
struct Neighbours {
  const Picked* near;
  const float* weight;  // of each
  float per_cutoff;
  float voxel;
};

// Neighbours of one particle, copied together.
struct Shares {
  Grow<float> x, y, z, weight;
};

}  // namespace grainvdb
#endif

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

/// Copies the neighbours within the cutoff of any of the corners. Returns their number.
std::size_t CopyNear(const Neighbours& from, const std::array<Corner, 8>& corners, Shares& to) {
  const float half = 0.5F * from.voxel;
  const float reach = 1 / from.per_cutoff;
  const BoxTest test{
      {corners[0].x + half, corners[0].y + half, corners[0].z + half}, {half, half, half}, reach * reach};
  const Picked& near = *from.near;
  float* const x = to.x.room(near.count);
  float* const y = to.y.room(near.count);
  float* const z = to.z.room(near.count);
  float* const w = to.weight.room(near.count);
  std::size_t n = 0;
  for (std::size_t i = 0; i < near.count; i += lanes) {
    const Voxels at{hn::Load(d, near.x.data() + i), hn::Load(d, near.y.data() + i), hn::Load(d, near.z.data() + i)};
    const auto some = near_box(at, test, near.count - i);
    store_some(at.x, some, d, x + n);
    store_some(at.y, some, d, y + n);
    store_some(at.z, some, d, z + n);
    n += store_some(hn::LoadU(d, from.weight + i), some, d, w + n);
  }
  return n;
}

/// Σ_β (weight_β Σ_n share_n (1-r)³(1+3r))² over the neighbours, r the distance of β from corner n.
double SumOfSquares(const Neighbours& from, const std::array<Corner, 8>& corners, Shares& scratch) {
  const std::size_t count = CopyNear(from, corners, scratch);
  const V one = hn::Set(d, 1.0F), three = hn::Set(d, 3.0F), scale = hn::Set(d, from.per_cutoff * from.per_cutoff);
  V sum = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += lanes) {
    const V x = hn::Load(d, scratch.x.data() + i), y = hn::Load(d, scratch.y.data() + i),
            z = hn::Load(d, scratch.z.data() + i);
    V share = hn::Zero(d);
    for (const Corner& c : corners) {
      const V dx = hn::Sub(x, hn::Set(d, c.x)), dy = hn::Sub(y, hn::Set(d, c.y)), dz = hn::Sub(z, hn::Set(d, c.z));
      const V r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
      const V r = hn::Sqrt(hn::Min(hn::Mul(r2, scale), one));
      const V p = hn::Sub(one, r);
      const V w = hn::Mul(hn::Mul(hn::Mul(p, p), p), hn::MulAdd(three, r, one));
      share = hn::MulAdd(w, hn::Set(d, c.share), share);
    }
    share = hn::Mul(share, hn::Load(d, scratch.weight.data() + i));
    const V square = hn::Mul(share, share);
    sum = hn::Add(sum, count - i < lanes ? hn::IfThenElseZero(hn::FirstN(d, count - i), square) : square);
  }
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(SumOfSquares);

namespace {

constexpr int block = 4;  // voxels along the edge of a block, whose neighbours are picked once for its particles

struct Work {
  explicit Work(const Topology& topology) : finder(topology) {}
  LeafFinder finder;
  LeafCandidates candidates;
  Picked near;
  Grow<float> weight;  // of those near
  Shares shares;
};

class OwnWeight {
 public:
  OwnWeight(const Lattice& lattice, const LucyKernel& kernel, const Columns3& position, std::span<const double> weight,
            const LeafBlocks& total, int channel, Outside outside, std::span<const std::uint8_t> wanted)
      : lattice_(lattice),
        kernel_(kernel),
        position_(position),
        weight_(weight),
        total_(total),
        channel_(channel),
        outside_(outside),
        wanted_(wanted),
        // The voxels around a particle may lie a voxel outside the stored period.
        buckets_(bin_points(lattice, position, kernel.cutoff() + lattice.voxel())),
        largest_(weight.empty() ? 1 : *std::max_element(weight.begin(), weight.end())),
        cutoff_(kernel.cutoff() / lattice.voxel()),
        reach_(cutoff_ + std::numbers::sqrt3) {}

  /// The factors of the particles of one cell.
  void run(std::size_t cell, Work& work, std::vector<double>& factors) const {
    const Coord& origin = buckets_.cells[cell];
    gather_candidates(buckets_, origin, reach_, work.candidates);
    for (int x = 0; x < leaf_edge; x += block)
      for (int y = 0; y < leaf_edge; y += block)
        for (int z = 0; z < leaf_edge; z += block) run_block(cell, {x, y, z, block}, work, factors);
  }

  std::size_t cells() const { return buckets_.cells.size(); }

 private:
  float unit() const { return static_cast<float>(1 / reach_); }

  void run_block(std::size_t cell, const VoxelBox& box, Work& work, std::vector<double>& factors) const {
    const Coord& origin = buckets_.cells[cell];
    bool begun = false;
    for (std::size_t e = buckets_.start[cell]; e < buckets_.start[cell + 1]; ++e) {
      if (!is_wanted(e) || !in_block(e, origin, box) || !is_stored(e)) continue;
      if (!begun) pick(box, work);
      begun = true;
      factors[buckets_.point[e]] = factor(e, origin, work);
    }
  }

  void pick(const VoxelBox& box, Work& work) const {
    pick_near(work.candidates, box, unit(), work.near);
    float* const weight = work.weight.room(work.near.count);
    for (std::size_t k = 0; k < work.near.count; ++k)
      weight[k] = static_cast<float>(weight_[buckets_.point[entry(work, k)]] / largest_);
  }
  static std::size_t entry(const Work& work, std::size_t near) {
    return work.candidates.entry[static_cast<std::size_t>(work.near.at[near])];
  }

  bool is_wanted(std::size_t e) const { return wanted_.empty() || wanted_[buckets_.point[e]] != 0; }

  bool in_block(std::size_t e, const Coord& origin, const VoxelBox& box) const {
    const auto along = [&](std::size_t axis, int first) {
      const double nearest = std::floor(buckets_.index[axis][e] + 0.5) - origin[static_cast<int>(axis)];
      return nearest >= first && nearest < first + box.edge;
    };
    return along(0, box.x) && along(1, box.y) && along(2, box.z);
  }

  /// Whether an entry is the image of its point that lies in the stored period.
  bool is_stored(std::size_t e) const {
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double x = position_[axis][buckets_.point[e]];
      if (buckets_.index[axis][e] != lattice_.wrap_index(a, lattice_.to_index(a, x))) return false;
    }
    return true;
  }

  /// (1 - w_αα)² + Σ_{β≠α} w_αβ²: nothing cancels where a particle is alone.
  double factor(std::size_t e, const Coord& origin, Work& work) const {
    const std::uint32_t p = buckets_.point[e];
    const Surroundings around = surroundings(lattice_, {position_[0][p], position_[1][p], position_[2][p]});
    std::array<Corner, 8> corners{};
    double own = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      const Coord& v = around[n].voxel;
      const double total = around[n].weight == 0 ? 1 : total_at(v, work);
      if (outside_ == Outside::undefined && !(total > 0)) return std::numeric_limits<double>::quiet_NaN();
      require_reached(v, total);
      const double share = around[n].weight / total;
      double r2 = 0;
      for (int a = 0; a < 3; ++a)
        r2 += std::pow((v[a] - buckets_.index[static_cast<std::size_t>(a)][e]) * lattice_.voxel(), 2);
      own += share * kernel_.value(r2);
      const auto local = [&](int axis) { return static_cast<float>((v[axis] - origin[axis] - 3.5) / reach_); };
      corners[n] = {local(0), local(1), local(2), static_cast<float>(share * kernel_.value(0) * largest_)};
    }
    own *= weight_[p];
    return (1 - own) * (1 - own) + others(e, corners, work);
  }

  double total_at(const Coord& anywhere, Work& work) const {
    const Coord voxel = lattice_.wrap(anywhere);
    const auto leaf = work.finder.leaf(leaf_origin(voxel));
    return leaf ? total_.block(*leaf, channel_)[leaf_offset(voxel)] : 0;
  }

  double others(std::size_t e, const std::array<Corner, 8>& corners, Work& work) const {
    std::size_t self = 0;
    while (entry(work, self) != e) ++self;
    const float weight = work.weight[self];
    work.weight[self] = 0;
    const double sum = HWY_DYNAMIC_DISPATCH(SumOfSquares)(
        {&work.near, work.weight.data(), static_cast<float>(reach_ / cutoff_), unit()}, corners, work.shares);
    work.weight[self] = weight;
    return sum;
  }

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const Columns3& position_;
  std::span<const double> weight_;
  const LeafBlocks& total_;
  int channel_;
  Outside outside_;
  std::span<const std::uint8_t> wanted_;
  Buckets buckets_;
  double largest_;  // weight
  double cutoff_;   // in voxels
  double reach_;    // in voxels: of the kernel about any of the eight voxels around a particle of a block
};

}  // namespace

std::vector<double> deviation_factors(const Lattice& lattice, const LucyKernel& kernel, const Columns3& position,
                                      std::span<const double> weight, const LeafBlocks& total, int channel,
                                      Outside outside, std::span<const std::uint8_t> wanted) {
  const OwnWeight own(lattice, kernel, position, weight, total, channel, outside, wanted);
  std::vector<double> factors(weight.size());
  tbb::enumerable_thread_specific<Work> work([&] { return Work(*total.topology); });
  parallel_for(own.cells(), [&](std::size_t cell) { own.run(cell, work.local(), factors); });
  return factors;
}
}  // namespace grainvdb
#endif
