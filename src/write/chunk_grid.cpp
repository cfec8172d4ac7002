#include "write/chunk_grid.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace grainvdb {
namespace {

constexpr std::uint64_t largest_edge = 32;

}  // namespace

ChunkGrid::ChunkGrid(const Coord& first, const Coord& last) : first_(first) {
  for (int axis = 0; axis < 3; ++axis) {
    if (last[axis] < first[axis]) throw std::invalid_argument("a written box needs at least one voxel");
    const auto n = static_cast<std::uint64_t>(std::int64_t{last[axis]} - first[axis] + 1);
    const std::uint64_t chunks = (n + largest_edge - 1) / largest_edge;
    const auto a = static_cast<std::size_t>(axis);
    voxels_[a] = n;
    chunk_[a] = (n + chunks - 1) / chunks;
  }
}

Extent3 ChunkGrid::from_first(const Coord& c) const {
  Extent3 v;
  for (int axis = 0; axis < 3; ++axis)
    v[static_cast<std::size_t>(axis)] = static_cast<std::uint64_t>(std::int64_t{c[axis]} - first_[axis]);
  return v;
}

std::size_t ChunkGrid::places_in(const OccupiedChunk& chunk, const Coord& leaf_origin, const LeafMask& mask,
                                 std::array<Place, leaf_size>& places) const {
  std::size_t n = 0;
  mask.for_each([&](int offset) {
    Extent3 v = from_first(voxel_at(leaf_origin, offset));
    for (std::size_t a = 0; a < 3; ++a) v[a] -= chunk.start[a];  // wraps to something large below the start
    if (v[0] < chunk_[0] && v[1] < chunk_[1] && v[2] < chunk_[2])
      places[n++] = {static_cast<std::size_t>(offset), (v[2] * chunk_[1] + v[1]) * chunk_[0] + v[0]};
  });
  return n;
}

std::vector<OccupiedChunk> ChunkGrid::occupied(const Topology& topology) const {
  // Per leaf, the chunks that the bounds of its active voxels touch: eight at most unless chunks are narrower than
  // leaves.
  using Touch = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t, std::size_t>;  // z, y, x of the chunk, leaf
  std::vector<Touch> touches;
  for (std::size_t leaf = 0; leaf < topology.leaf_count(); ++leaf) {
    Extent3 low, high{};
    low.fill(std::numeric_limits<std::uint64_t>::max());
    topology.mask(leaf).for_each([&](int offset) {
      const Extent3 v = from_first(voxel_at(topology.origin(leaf), offset));
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], v[a] / chunk_[a]);
        high[a] = std::max(high[a], v[a] / chunk_[a]);
      }
    });
    for (std::uint64_t z = low[2]; z <= high[2]; ++z)
      for (std::uint64_t y = low[1]; y <= high[1]; ++y)
        for (std::uint64_t x = low[0]; x <= high[0]; ++x) touches.emplace_back(z, y, x, leaf);
  }
  std::sort(touches.begin(), touches.end());

  std::vector<OccupiedChunk> chunks;
  for (const auto& [z, y, x, leaf] : touches) {
    const Extent3 start{x * chunk_[0], y * chunk_[1], z * chunk_[2]};
    if (chunks.empty() || chunks.back().start != start) chunks.push_back({start, {}});
    chunks.back().leaves.push_back(leaf);
  }
  return chunks;
}

}  // namespace grainvdb
