#include "trace/flow_blocks.hpp"

#include <limits>

#include "base/parallel.hpp"

namespace grainvdb {
namespace {

constexpr float no_value = std::numeric_limits<float>::quiet_NaN();

/// A run of voxels along one axis of a block that lie in one leaf, periods wrapped.
struct Run {
  int to = 0;               ///< first place in the block
  std::int32_t origin = 0;  ///< of the leaf
  int from = 0;             ///< first place in the leaf
  int count = 0;
};

std::vector<Run> runs_along(const Lattice& lattice, int axis, std::int32_t first, int edge) {
  std::vector<Run> runs;
  for (int i = 0; i < edge; ++i) {
    const std::int32_t voxel = lattice.wrap(axis, first + i);
    const int in_leaf = voxel & (leaf_edge - 1);
    const std::int32_t origin = voxel - in_leaf;
    if (!runs.empty() && runs.back().origin == origin && runs.back().from + runs.back().count == in_leaf) {
      ++runs.back().count;
    } else {
      runs.push_back({i, origin, in_leaf, 1});
    }
  }
  return runs;
}

/// Copies leaves into blocks.
class Filler {
 public:
  Filler(FlowBlocks& blocks, const SparseField& velocity, const SparseField* shear_rate)
      : blocks_(blocks), velocity_(velocity), shear_rate_(shear_rate) {}

  void fill(std::size_t leaf) {
    const Coord& origin = velocity_.topology()->origin(leaf);
    std::array<std::vector<Run>, 3> runs;
    for (int a = 0; a < 3; ++a)
      runs[static_cast<std::size_t>(a)] = runs_along(blocks_.lattice, a, origin[a] - blocks_.below, blocks_.edge);
    float* const block = blocks_.values.data() + leaf * blocks_.block_size();
    for (const Run& x : runs[0])
      for (const Run& y : runs[1])
        for (const Run& z : runs[2]) {
          const std::size_t from = blocks_.index.find({x.origin, y.origin, z.origin});
          if (from != blocks_.index.leaf_count()) copy(from, x, y, z, block);
        }
  }

 private:
  void copy(std::size_t leaf, const Run& x, const Run& y, const Run& z, float* block) {
    const LeafMask& active = velocity_.topology()->mask(leaf);
    const float* const u[] = {velocity_.leaf(leaf, 0), velocity_.leaf(leaf, 1), velocity_.leaf(leaf, 2)};
    const float* const rate = shear_rate_ == nullptr ? nullptr : shear_rate_->leaf(leaf);
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j)
        for (int k = 0; k < z.count; ++k) {
          const int voxel = leaf_offset({x.from + i, y.from + j, z.from + k});
          if (!active.test(voxel)) continue;
          float* const to = block + blocks_.offset({x.to + i, y.to + j, z.to + k});
          for (int c = 0; c < 3; ++c) to[c] = u[c][voxel];
          to[3] = rate == nullptr ? 0.0F : rate[voxel];
        }
  }

  FlowBlocks& blocks_;
  const SparseField& velocity_;
  const SparseField* shear_rate_;
};

}  // namespace

FlowBlocks::FlowBlocks(const Lattice& l, const SparseField& velocity, const SparseField* shear_rate, Interpolation i)
    : lattice(l),
      interpolation(i),
      below(i == Interpolation::trilinear ? 0 : 1),
      edge(leaf_edge + 1 + 2 * below),
      index(*velocity.topology()),
      values((index.leaf_count() + 1) * block_size(), no_value) {
  Filler filler(*this, velocity, shear_rate);
  parallel_for(index.leaf_count(), [&](std::size_t leaf) { filler.fill(leaf); });
}

}  // namespace grainvdb
