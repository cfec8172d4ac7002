#pragma once
/// The fast particle splat of one leaf: single-precision sums over bricks of voxels that fill a vector register,
/// compiled for every instruction set the library supports and chosen at run time.
#include <cstddef>
#include <cstdint>

namespace grainvdb {

/// What a leaf's sums are made of. Candidates are the entries whose support can touch the leaf; coordinates are in
/// units of the cutoff, relative to the leaf's first voxel.
struct LeafSplat {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  const float* q = nullptr;  ///< values of the candidates, [candidate][stride]
  std::size_t count = 0;     ///< of candidates
  std::size_t stride = 0;    ///< of q, at least `channels`
  int channels = 0;
  float voxel = 0;  ///< edge of a voxel in units of the cutoff
};

/// out[channel][offset] = Σ q (1-r)³(1+3r) over the candidates, for the 512 voxels of the leaf. `scratch` is reused
/// from leaf to leaf.
class BrickScratch;
void splat_leaf(const LeafSplat& leaf, BrickScratch& scratch, float* out);

/// The instruction set that splat_leaf uses on this machine.
const char* splat_target();

}  // namespace grainvdb
