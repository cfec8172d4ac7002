#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.hpp"
#include "splat/candidates.hpp"
#include "splat/gather.hpp"
#include "splat/splat.hpp"

namespace grainvdb {
namespace {

struct TopologyWork {
  LeafCandidates candidates;
  NearBlocks near;
};

/// Whether W > 0 at a voxel for any candidate, in double.
bool reached(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const LeafCandidates& candidates,
             const Coord& voxel) {
  for (std::size_t k = 0; k < candidates.count; ++k) {
    double r2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = (voxel[a] - buckets.index[a][candidates.entry[k]]) * lattice.voxel();
      r2 += d * d;
    }
    if (kernel.value(r2) > 0) return true;
  }
  return false;
}

bool holds(const LeafMask& mask, const LeafMask& part) {
  for (std::size_t w = 0; w < mask.words.size(); ++w)
    if ((part.words[w] & ~mask.words[w]) != 0) return false;
  return true;
}

}  // namespace

std::shared_ptr<const Topology> particle_topology(const Lattice& lattice, const LucyKernel& kernel,
                                                  const Buckets& buckets, const Region* wanted) {
  const double cutoff = kernel.cutoff() / lattice.voxel();
  std::vector<Coord> leaves = leaves_in_reach(lattice, buckets, cutoff);
  if (wanted != nullptr) std::erase_if(leaves, [&](const Coord& leaf) { return !wanted->holds(leaf); });
  std::vector<LeafMask> masks(leaves.size());
  tbb::enumerable_thread_specific<TopologyWork> works;
  parallel_for(leaves.size(), [&](std::size_t l) {
    TopologyWork& work = works.local();
    const LeafMask stored = LeafWindow(lattice, leaves[l]).mask();
    LeafMask inside;
    LeafMask perhaps;
    // Within the material the particles of a leaf alone cover it.
    gather_own(buckets, leaves[l], cutoff, work.candidates);
    cover_some(work.candidates, static_cast<float>(1 / cutoff), inside);
    if (holds(inside, stored)) {
      masks[l] = stored;
      return;
    }
    gather_candidates(buckets, leaves[l], cutoff, work.candidates);
    cover(work.candidates, static_cast<float>(1 / cutoff), work.near, inside, perhaps);
    for (std::size_t w = 0; w < stored.words.size(); ++w) {
      masks[l].words[w] = inside.words[w] & stored.words[w];
      perhaps.words[w] &= stored.words[w] & ~inside.words[w];
    }
    perhaps.for_each([&](int v) {
      if (reached(lattice, kernel, buckets, work.candidates, voxel_at(leaves[l], v))) masks[l].set(v);
    });
  });
  return std::make_shared<const Topology>(std::move(leaves), std::move(masks));
}

}  // namespace grainvdb
