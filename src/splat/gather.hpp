#pragma once
/// The gather that all splats share: each leaf visits the bucketed entries within reach in one fixed order.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "bin/buckets.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "splat/leaf_consumer.hpp"

namespace grainvdb {

/// A leaf and the range of its voxels (0 … 7 along each axis) that belong to the stored period.
struct LeafWindow {
  LeafWindow(const Lattice& lattice, const Coord& leaf);
  Coord origin;
  std::array<int, 3> first{};
  std::array<int, 3> last{};
  LeafMask mask() const;
};

/// The leaves with a voxel of the stored period within `reach` (in voxels) of the extent of any cell's entries,
/// ascending.
std::vector<Coord> leaves_in_reach(const Lattice& lattice, const Buckets& buckets, double reach);

/// Calls f(cell) for all cells that a sphere of radius `reach` (in voxels) about a voxel of the leaf can touch, in
/// ascending order.
template <class F>
void for_each_cell(const Buckets& buckets, const Coord& leaf, double reach, F&& f) {
  // A cell holds index positions in [origin - ½, origin + 7½).
  std::array<std::int32_t, 3> low{};
  std::array<std::int32_t, 3> high{};
  for (int a = 0; a < 3; ++a) {
    low[a] = static_cast<std::int32_t>(std::floor(leaf[a] - reach)) & ~(leaf_edge - 1);
    high[a] = static_cast<std::int32_t>(std::ceil(leaf[a] + leaf_edge - 1 + reach)) & ~(leaf_edge - 1);
  }
  auto from = buckets.cells.begin();
  for (std::int32_t x = low[0]; x <= high[0]; x += leaf_edge)
    for (std::int32_t y = low[1]; y <= high[1]; y += leaf_edge) {
      from = std::lower_bound(from, buckets.cells.end(), Coord{x, y, low[2]});
      for (; from != buckets.cells.end() && from->x == x && from->y == y && from->z <= high[2]; ++from)
        f(static_cast<std::size_t>(from - buckets.cells.begin()));
    }
}

/// Calls f(entry) for the entries of those cells, in each the points in ascending order.
template <class F>
void for_each_entry(const Buckets& buckets, const Coord& leaf, double reach, F&& f) {
  for_each_cell(buckets, leaf, reach, [&](std::size_t cell) {
    for (std::size_t e = buckets.start[cell]; e < buckets.start[cell + 1]; ++e) f(e);
  });
}

/// Calls f(offset, d) for the voxels of the window within `reach` (in voxels) of index position u, in ascending order;
/// d is the voxel centre minus u, in voxels. Voxels that lie outside by rounding only may be visited too.
template <class F>
void for_each_voxel(const LeafWindow& window, const Vec3& u, double reach, F&& f) {
  const double reach2 = reach * reach * (1 + 1e-12);
  const Vec3 start{window.origin.x - u[0], window.origin.y - u[1], window.origin.z - u[2]};
  for (int i = window.first[0]; i <= window.last[0]; ++i) {
    const double dx = start[0] + i;
    const double rest_x = reach2 - dx * dx;
    if (rest_x < 0) continue;
    for (int j = window.first[1]; j <= window.last[1]; ++j) {
      const double dy = start[1] + j;
      const double rest = rest_x - dy * dy;
      if (rest < 0) continue;
      const double half = std::sqrt(rest) + 1e-12 * reach;
      const double low = std::max(std::ceil(-half - start[2]), static_cast<double>(window.first[2]));
      const double high = std::min(std::floor(half - start[2]), static_cast<double>(window.last[2]));
      if (low > high) continue;
      const int last = static_cast<int>(high);
      for (int k = static_cast<int>(low); k <= last; ++k) f((i << 6) | (j << 3) | k, Vec3{dx, dy, start[2] + k});
    }
  }
}

/// The position of an entry in index space.
inline Vec3 entry_index(const Buckets& buckets, std::size_t entry) {
  return {buckets.index[0][entry], buckets.index[1][entry], buckets.index[2][entry]};
}

/// The voxels of the stored period with a positive weight. `visit(entry, window, f)` calls f(offset, weight) with a
/// callable weight for every voxel that the entry may reach.
template <class Visit>
std::shared_ptr<const Topology> reached_voxels(const Lattice& lattice, const Buckets& buckets, double reach,
                                               const Visit& visit) {
  std::vector<Coord> leaves = leaves_in_reach(lattice, buckets, reach);
  std::vector<LeafMask> masks(leaves.size());
  parallel_for(leaves.size(), [&](std::size_t l) {
    const LeafWindow window(lattice, leaves[l]);
    const LeafMask all = window.mask();
    LeafMask& mask = masks[l];
    for_each_entry(buckets, leaves[l], reach, [&](std::size_t entry) {
      if (mask == all) return;
      visit(entry, window, [&](int offset, auto&& weight) {
        if (!mask.test(offset) && weight() > 0) mask.set(offset);
      });
    });
  });
  return std::make_shared<const Topology>(std::move(leaves), std::move(masks));
}

/// Adds up the entries at every active voxel: add(entry, window, sums) adds one entry's terms to sums[offset][channel].
template <class Add>
void gather_leaves(const Lattice& lattice, const Buckets& buckets, double reach, const Topology& topology,
                   std::size_t channels, const Add& add, const LeafConsumer& consume) {
  // Sums are kept [offset][channel] while they grow: the channels of a voxel lie side by side, where [channel][offset]
  // would put them 4096 bytes apart, into the same cache set.
  struct Work {
    std::vector<double> sums, values;
  };
  tbb::enumerable_thread_specific<Work> works;
  parallel_for(topology.leaf_count(), [&](std::size_t l) {
    Work& work = works.local();
    work.sums.assign(leaf_size * channels, 0.0);
    work.values.assign(leaf_size * channels, 0.0);
    const LeafWindow window(lattice, topology.origin(l));
    for_each_entry(buckets, window.origin, reach, [&](std::size_t entry) { add(entry, window, work.sums.data()); });
    topology.mask(l).for_each([&](int offset) {
      const auto v = static_cast<std::size_t>(offset);
      for (std::size_t c = 0; c < channels; ++c) work.values[c * leaf_size + v] = work.sums[v * channels + c];
    });
    consume(l, work.values.data());
  });
}

/// The same, kept in buffers.
template <class Add>
LeafBuffers gather(const Lattice& lattice, const Buckets& buckets, double reach,
                   std::shared_ptr<const Topology> topology, int channels, const Add& add) {
  return kept_in_buffers(std::move(topology), channels, [&](const Topology& leaves, const LeafConsumer& consume) {
    gather_leaves(lattice, buckets, reach, leaves, static_cast<std::size_t>(channels), add, consume);
  });
}

}  // namespace grainvdb
