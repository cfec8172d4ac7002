#include "pipeline/wanted_leaves.hpp"

namespace grainvdb {

Region wanted_leaves(const Region& region, const Halo& halo, const Lattice& lattice, const LucyKernel& kernel) {
  Region leaves = region;
  if (halo.stencil > 0) leaves = leaves.grown(halo.stencil).wrapped(lattice);
  for (int n = 0; n < halo.samplings; ++n) {
    const Region cells = leaves.grown(kernel.cutoff() / lattice.voxel());
    leaves = cells.grown(1).wrapped(lattice);  // the voxels around each particle
  }
  if (halo.whole_axes != Halo{}.whole_axes) leaves = leaves.everywhere_along(halo.whole_axes);
  return leaves;
}

}  // namespace grainvdb
