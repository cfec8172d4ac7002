#include "bin/least_leaves.hpp"

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

}  // namespace grainvdb
