#include <algorithm>
#include <cmath>

#include "grainvdb/kernel.hpp"

namespace grainvdb {
namespace {

/// Σ W over the voxel centres around a grain at x, with voxels of edge 1.
double volume_at(const LucyKernel& kernel, const Vec3& x) {
  const int n = static_cast<int>(std::ceil(kernel.cutoff())) + 1;
  double sum = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k)
        sum += kernel.value((x[0] - i) * (x[0] - i) + (x[1] - j) * (x[1] - j) + (x[2] - k) * (x[2] - k));
  return sum;
}

}  // namespace

// The error is even and periodic in each coordinate and the same for any order of them, so an eighth of a voxel divided
// by six is enough. Its extremes lie at points of symmetry, which the quarters of a voxel contain.
double grain_volume_error(double cutoff_in_voxels) {
  const LucyKernel kernel(std::min(cutoff_in_voxels, 6.0));
  double worst = 0;
  for (double x : {0.0, 0.25, 0.5})
    for (double y : {0.0, 0.25, 0.5})
      for (double z : {0.0, 0.25, 0.5})
        if (x <= y && y <= z) worst = std::max(worst, std::abs(volume_at(kernel, {x, y, z}) - 1));
  return worst;
}

}  // namespace grainvdb
