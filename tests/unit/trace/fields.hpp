#pragma once
/// Fields given by functions of the place, for tracers to move through.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/flow.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb::testing {

/// What inactive voxels hold: a sample that reads one gives a result that no test expects.
inline constexpr float never_read = 1e30F;

/// The voxels of the box first … last for which `active` holds.
inline std::shared_ptr<const Topology> voxels_between(
    const Coord& first, const Coord& last,
    const std::function<bool(const Coord&)>& active = [](const Coord&) { return true; }) {
  std::map<Coord, LeafMask> leaves;
  for (std::int32_t x = first.x; x <= last.x; ++x)
    for (std::int32_t y = first.y; y <= last.y; ++y)
      for (std::int32_t z = first.z; z <= last.z; ++z)
        if (active({x, y, z})) leaves[leaf_origin({x, y, z})].set(leaf_offset({x, y, z}));
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (const auto& [origin, mask] : leaves) {
    origins.push_back(origin);
    masks.push_back(mask);
  }
  return std::make_shared<Topology>(std::move(origins), std::move(masks));
}

/// f(place, component) at the voxel centres.
inline SparseField field_of(const std::string& name, int components, const Lattice& lattice,
                            const std::shared_ptr<const Topology>& topology,
                            const std::function<double(const Vec3&, int component)>& f) {
  SparseField field({name, "1", components, "", "", never_read}, topology, lattice);
  for (std::size_t l = 0; l < topology->leaf_count(); ++l)
    for (int c = 0; c < components; ++c)
      topology->mask(l).for_each([&](int v) {
        field.leaf(l, c)[v] = static_cast<float>(f(lattice.centre(voxel_at(topology->origin(l), v)), c));
      });
  return field;
}

using Velocity = std::function<Vec3(const Vec3&)>;

/// A grid of the velocity and, where given, the shear rate.
inline std::shared_ptr<const FlowGrid> grid_of(const Lattice& lattice, const std::shared_ptr<const Topology>& topology,
                                               Interpolation interpolation, const Velocity& u,
                                               const std::function<double(const Vec3&)>& rate = {}) {
  const SparseField velocity = field_of("velocity", 3, lattice, topology,
                                        [&](const Vec3& x, int c) { return u(x)[static_cast<std::size_t>(c)]; });
  if (!rate) return std::make_shared<FlowGrid>(lattice, velocity, nullptr, interpolation);
  const SparseField shear_rate =
      field_of("shear_rate", 1, lattice, topology, [&](const Vec3& x, int) { return rate(x); });
  return std::make_shared<FlowGrid>(lattice, velocity, &shear_rate, interpolation);
}

/// An open box from lo to hi.
inline Box open_box(const Vec3& lo, const Vec3& hi) {
  return {lo, hi, {false, false, false}};
}

}  // namespace grainvdb::testing
