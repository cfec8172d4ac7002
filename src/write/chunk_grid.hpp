#pragma once
/// The box of written voxels, cut into chunks of at most 32³ of about equal size, and the chunks that hold something.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Counts along x, y and z.
using Extent3 = std::array<std::uint64_t, 3>;

/// One chunk: the offset of its first voxel from the first voxel of the box, and the leaves that may reach into it.
struct OccupiedChunk {
  Extent3 start{};
  std::vector<std::size_t> leaves;
};

class ChunkGrid {
 public:
  /// The voxels first … last, inclusive. Throws std::invalid_argument when there are none.
  ChunkGrid(const Coord& first, const Coord& last);

  /// Voxels of the box.
  const Extent3& voxels() const { return voxels_; }
  /// Voxels of a chunk: per axis n = ceil(voxels/32) chunks of ceil(voxels/n), so that the last reaches less than n
  /// voxels beyond the box.
  const Extent3& chunk() const { return chunk_; }

  /// The chunks that hold active voxels, z slowest. The active voxels must lie in the box.
  std::vector<OccupiedChunk> occupied(const Topology& topology) const;

  /// Fills `out` with a whole chunk, laid out [z][y][x][component]: the background, and over it the active voxels.
  /// `values(leaf, component)` points to the leaf_size values of a component in a leaf.
  template <class T, class Values>
  void gather(const OccupiedChunk& chunk, const Topology& topology, std::size_t components, T background,
              const Values& values, std::vector<T>& out) const;

 private:
  /// An active voxel of a leaf that lies in a chunk: its offset in the leaf, and its number in the chunk.
  struct Place {
    std::size_t offset;
    std::size_t voxel;
  };
  /// Lists the places of a leaf and returns how many there are.
  std::size_t places_in(const OccupiedChunk& chunk, const Coord& leaf_origin, const LeafMask& mask,
                        std::array<Place, leaf_size>& places) const;
  Extent3 from_first(const Coord& c) const;

  Coord first_;
  Extent3 voxels_{};
  Extent3 chunk_{};
};

template <class T, class Values>
void ChunkGrid::gather(const OccupiedChunk& chunk, const Topology& topology, std::size_t components, T background,
                       const Values& values, std::vector<T>& out) const {
  out.assign(chunk_[0] * chunk_[1] * chunk_[2] * components, background);
  std::array<Place, leaf_size> places;
  for (const std::size_t leaf : chunk.leaves) {
    const std::size_t n = places_in(chunk, topology.origin(leaf), topology.mask(leaf), places);
    for (std::size_t component = 0; component < components; ++component) {
      const T* const from = values(leaf, component);
      for (std::size_t i = 0; i < n; ++i) out[places[i].voxel * components + component] = from[places[i].offset];
    }
  }
}

}  // namespace grainvdb
