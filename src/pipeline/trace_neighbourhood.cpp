#include "pipeline/trace_neighbourhood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "pipeline/wanted_leaves.hpp"

namespace grainvdb {

/// Calls f(leaf) for the leaves near x until it returns false; whether it never did. Places too far away have none.
template <class F>
bool TraceNeighbourhood::all_leaves(const Vec3& x, double reach, const F& f) const {
  constexpr double farthest = 1 << 29;
  std::array<std::vector<std::int32_t>, 3> origins;
  for (int a = 0; a < 3; ++a) {
    const double u = lattice_.wrap_index(a, lattice_.to_index(a, x[static_cast<std::size_t>(a)]));
    if (!(std::abs(u) + reach < farthest)) return false;
    const auto first = static_cast<std::int32_t>(std::floor(u - reach));
    const auto last = static_cast<std::int32_t>(std::floor(u + reach)) + 1;
    const auto& period = lattice_.period(a);
    auto& along = origins[static_cast<std::size_t>(a)];
    const std::int32_t end = period ? std::min(last, first + period->count - 1) : last;
    for (std::int32_t i = first; i <= end; ++i) {
      const std::int32_t origin = lattice_.wrap(a, i) & ~(leaf_edge - 1);
      if (std::find(along.begin(), along.end(), origin) == along.end()) along.push_back(origin);
    }
  }
  for (const std::int32_t i : origins[0])
    for (const std::int32_t j : origins[1])
      for (const std::int32_t k : origins[2])
        if (!f(Coord{i, j, k})) return false;
  return true;
}

void TraceNeighbourhood::add(const Vec3& x, double reach) {
  all_leaves(x, reach, [&](const Coord& leaf) {
    leaves_.insert(leaf);
    return true;
  });
}

void TraceNeighbourhood::add_way(const Vec3& x, const Vec3& way) {
  const double voxels = std::hypot(way[0], way[1], way[2]) / lattice_.voxel();
  const double length = std::min(voxels, farthest_);
  const auto pieces = static_cast<std::size_t>(std::ceil(length / leaf_edge));
  add(x, leaf_edge);
  for (std::size_t i = 1; i <= pieces; ++i) {
    const double s = length / voxels * static_cast<double>(i) / static_cast<double>(pieces);
    add({x[0] + s * way[0], x[1] + s * way[1], x[2] + s * way[2]}, leaf_edge);
  }
}

bool TraceNeighbourhood::holds(const Vec3& x, double reach) const {
  return all_leaves(x, reach, [&](const Coord& leaf) { return leaves_.contains(leaf); });
}

double share_of_particles(const Particles& particles, const Region& region, const Plan& plan, const Lattice& lattice,
                          double cutoff) {
  if (particles.size() == 0) return 1;
  Halo halo;
  for (const auto& [name, one] : plan.halos) halo = merged(halo, one);
  const LucyKernel kernel(cutoff);
  const Region cells = wanted_leaves(region, halo, lattice, kernel).grown(cutoff / lattice.voxel()).wrapped(lattice);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Coord voxel;
    std::int32_t* const to[] = {&voxel.x, &voxel.y, &voxel.z};
    for (int a = 0; a < 3; ++a) {
      const double u = std::floor(lattice.to_index(a, particles.position[static_cast<std::size_t>(a)][i]) + 0.5);
      constexpr double most = 1 << 30;
      *to[a] = lattice.wrap(a, static_cast<std::int32_t>(std::clamp(u, -most, most)));
    }
    inside += cells.holds(leaf_origin(voxel)) ? 1U : 0U;
  }
  return static_cast<double>(inside) / static_cast<double>(particles.size());
}

bool neighbourhood_pays(double share, double cutoff_in_voxels, int passes) {
  constexpr double reading = 100;
  const double values = 4 * std::numbers::pi / 3 * std::pow(cutoff_in_voxels, 3);
  return passes * (reading + share * values) < reading + values;
}

}  // namespace grainvdb
