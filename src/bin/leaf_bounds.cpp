#include "bin/leaf_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

double least_leaves(const Lattice& lattice, const Columns3& position, double cutoff) {
  // In a period that the edge does not divide, the last cube is cut: a slightly larger edge would overlap, a smaller
  // one is safe, so each axis has its own.
  const double longest = cutoff / lattice.voxel() / std::numbers::sqrt3;
  Vec3 edge{longest, longest, longest};
  for (int a = 0; a < 3; ++a)
    if (const auto& period = lattice.period(a)) edge[a] = period->count / std::ceil(period->count / longest);

  std::vector<Coord> cubes(position[0].size());
  for (std::size_t p = 0; p < cubes.size(); ++p) {
    const auto cube = [&](int axis) {
      const double u = lattice.wrap_index(axis, lattice.to_index(axis, position[axis][p]));
      const double first = lattice.period(axis) ? lattice.period(axis)->first - 0.5 : 0.0;
      return static_cast<std::int32_t>(std::floor((u - first) / edge[axis]));
    };
    cubes[p] = {cube(0), cube(1), cube(2)};
  }
  std::sort(cubes.begin(), cubes.end());
  const auto count = std::unique(cubes.begin(), cubes.end()) - cubes.begin();
  return static_cast<double>(count) * edge[0] * edge[1] * edge[2] / leaf_size;
}

double most_leaves(const Lattice& lattice, const Columns3& position, double reach) {
  if (position[0].empty()) return 0;
  const double r = reach / lattice.voxel();
  // A stretch of n voxels touches at most n/8 + 2 leaves.
  const auto touched = [](double voxels) { return voxels / leaf_edge + 2; };
  double box = 1;
  for (int a = 0; a < 3; ++a) {
    const auto [least, greatest] = std::minmax_element(position[a].begin(), position[a].end());
    double extent = (*greatest - *least) / lattice.voxel() + 2 * r;
    if (const auto& period = lattice.period(a)) extent = std::min(extent, static_cast<double>(period->count));
    box *= touched(extent);
  }
  const double each = touched(2 * r);
  // Along a periodic axis images may touch leaves at both ends of the period.
  return std::min(box, 8 * each * each * each * static_cast<double>(position[0].size()));
}

}  // namespace grainvdb
