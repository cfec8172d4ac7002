#include "derive/central_difference.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "grainvdb/stage.hpp"

namespace grainvdb {
namespace {

/// Reads voxels near one leaf. Most lie in the leaf itself; the last other leaf is remembered, since neighbouring
/// voxels ask for the same one.
class NearbyReader {
 public:
  NearbyReader(const Lattice& lattice, const SparseField& field, std::size_t leaf)
      : lattice_(lattice),
        field_(field),
        topology_(*field.topology()),
        home_origin_(topology_.origin(leaf)),
        home_(leaf),
        other_origin_(home_origin_),
        other_(leaf) {}

  /// The value at a voxel or at the stored voxel that it is an image of; nothing where undefined.
  std::optional<Vec3> operator()(const Coord& anywhere) {
    const Coord c = lattice_.wrap(anywhere);
    const std::optional<std::size_t> leaf = leaf_of(c);
    const int offset = leaf_offset(c);
    if (!leaf || !topology_.mask(*leaf).test(offset)) return std::nullopt;
    Vec3 v;
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = static_cast<double>(field_.leaf(*leaf, static_cast<int>(i))[offset]);
      if (std::isnan(v[i])) return std::nullopt;
    }
    return v;
  }

 private:
  std::optional<std::size_t> leaf_of(const Coord& c) {
    const Coord origin = leaf_origin(c);
    if (origin == home_origin_) return home_;
    if (origin != other_origin_) {
      other_origin_ = origin;
      other_ = topology_.find(origin);
    }
    return other_;
  }

  const Lattice& lattice_;
  const SparseField& field_;
  const Topology& topology_;
  Coord home_origin_;
  std::size_t home_;
  Coord other_origin_;
  std::optional<std::size_t> other_;
};

Coord shifted(Coord c, int axis, std::int32_t by) {
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) += by;
  return c;
}

struct AxisDerivative {
  Vec3 value;
  std::optional<Reason> reason;
};

AxisDerivative one_sided(NearbyReader& read, const Coord& c, int axis, int side, double h, const Vec3& u0,
                         const Vec3& u1) {
  const std::optional<Vec3> u2 = read(shifted(c, axis, 2 * side));
  Vec3 d;
  for (std::size_t i = 0; i < 3; ++i)
    d[i] = side * (u2 ? (4 * (u1[i] - u0[i]) - ((*u2)[i] - u0[i])) / (2 * h) : (u1[i] - u0[i]) / h);
  return {d, Reason::one_sided_gradient};
}

AxisDerivative derivative(NearbyReader& read, const Coord& c, int axis, double h, const Vec3& u0) {
  const std::optional<Vec3> below = read(shifted(c, axis, -1));
  const std::optional<Vec3> above = read(shifted(c, axis, 1));
  if (below && above) {
    Vec3 d;
    for (std::size_t i = 0; i < 3; ++i) d[i] = ((*above)[i] - (*below)[i]) / (2 * h);
    return {d, std::nullopt};
  }
  if (above) return one_sided(read, c, axis, 1, h, u0, *above);
  if (below) return one_sided(read, c, axis, -1, h, u0, *below);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {{nan, nan, nan}, Reason::no_gradient};
}

}  // namespace

void central_difference(const Lattice& lattice, const SparseField& u, SparseField& out, Mask& mask) {
  const Topology& topology = *u.topology();
  for_each_leaf(topology, [&](std::size_t leaf) {
    NearbyReader read(lattice, u, leaf);
    topology.mask(leaf).for_each([&](int offset) {
      const Coord c = voxel_at(topology.origin(leaf), offset);
      const std::optional<Vec3> u0 = read(c);
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        const AxisDerivative d =
            u0 ? derivative(read, c, axis, lattice.voxel(), *u0) : AxisDerivative{{nan, nan, nan}, std::nullopt};
        if (d.reason) mask.add(leaf, offset, *d.reason);
        for (int i = 0; i < 3; ++i)
          out.leaf(leaf, 3 * i + axis)[offset] = static_cast<float>(d.value[static_cast<std::size_t>(i)]);
      }
    });
  });
}

}  // namespace grainvdb
