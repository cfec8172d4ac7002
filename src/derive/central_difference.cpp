#include "derive/central_difference.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "grainvdb/stage.hpp"

namespace grainvdb {
namespace {

template <std::size_t N>
using Values = std::array<double, N>;

/// Reads voxels near one leaf. Most lie in the leaf itself; the last other leaf is remembered, since neighbouring
/// voxels ask for the same one.
template <std::size_t N>
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
  std::optional<Values<N>> operator()(const Coord& anywhere) {
    const Coord c = lattice_.wrap(anywhere);
    const std::optional<std::size_t> leaf = leaf_of(c);
    const int offset = leaf_offset(c);
    if (!leaf || !topology_.mask(*leaf).test(offset)) return std::nullopt;
    Values<N> v;
    for (std::size_t i = 0; i < N; ++i) {
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

template <std::size_t N>
struct AxisDerivative {
  Values<N> value;
  std::optional<Reason> reason;
};

template <std::size_t N>
AxisDerivative<N> one_sided(NearbyReader<N>& read, const Coord& c, int axis, int side, double h, const Values<N>& u0,
                            const Values<N>& u1) {
  const std::optional<Values<N>> u2 = read(shifted(c, axis, 2 * side));
  Values<N> d;
  for (std::size_t i = 0; i < N; ++i)
    d[i] = side * (u2 ? (4 * (u1[i] - u0[i]) - ((*u2)[i] - u0[i])) / (2 * h) : (u1[i] - u0[i]) / h);
  return {d, Reason::one_sided_gradient};
}

template <std::size_t N>
Values<N> undefined() {
  Values<N> v;
  v.fill(std::numeric_limits<double>::quiet_NaN());
  return v;
}

template <std::size_t N>
AxisDerivative<N> derivative(NearbyReader<N>& read, const Coord& c, int axis, double h, const Values<N>& u0,
                             Reason none) {
  const std::optional<Values<N>> below = read(shifted(c, axis, -1));
  const std::optional<Values<N>> above = read(shifted(c, axis, 1));
  if (below && above) {
    Values<N> d;
    for (std::size_t i = 0; i < N; ++i) d[i] = ((*above)[i] - (*below)[i]) / (2 * h);
    return {d, std::nullopt};
  }
  if (above) return one_sided(read, c, axis, 1, h, u0, *above);
  if (below) return one_sided(read, c, axis, -1, h, u0, *below);
  return {undefined<N>(), none};
}

template <std::size_t N>
void differentiate(const Lattice& lattice, const SparseField& u, SparseField& out, Mask& mask, Reason none) {
  const Topology& topology = *u.topology();
  for_each_leaf(topology, [&](std::size_t leaf) {
    NearbyReader<N> read(lattice, u, leaf);
    topology.mask(leaf).for_each([&](int offset) {
      const Coord c = voxel_at(topology.origin(leaf), offset);
      const std::optional<Values<N>> u0 = read(c);
      for (int axis = 0; axis < 3; ++axis) {
        const AxisDerivative<N> d = u0 ? derivative(read, c, axis, lattice.voxel(), *u0, none)
                                       : AxisDerivative<N>{undefined<N>(), std::nullopt};
        if (d.reason) mask.add(leaf, offset, *d.reason);
        for (std::size_t i = 0; i < N; ++i)
          out.leaf(leaf, 3 * static_cast<int>(i) + axis)[offset] = static_cast<float>(d.value[i]);
      }
    });
  });
}

}  // namespace

void central_difference(const Lattice& lattice, const SparseField& u, SparseField& out, Mask& mask, Reason none) {
  if (u.components() == 1) {
    differentiate<1>(lattice, u, out, mask, none);
  } else {
    differentiate<3>(lattice, u, out, mask, none);
  }
}

}  // namespace grainvdb
