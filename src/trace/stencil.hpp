#pragma once
/// Fields of any number of components at a place, straight from their leaves.
#include <array>
#include <cstddef>
#include <cstdint>

#include "grainvdb/flow.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/sparse_field.hpp"
#include "trace/leaf_index.hpp"

namespace grainvdb {

/// The voxels around a place and their weights. It serves all fields of one topology.
class Stencil {
 public:
  /// `index` is that of the topology.
  Stencil(const Lattice& lattice, const Topology& topology, const LeafIndex& index, Interpolation interpolation);

  /// Puts the stencil at x, within 2³⁰ voxels of the origin along axes without period.
  void move_to(const Vec3& x);

  /// Whether the eight voxels around are active.
  bool inside() const { return eight_.active; }

  /// The components of a field into to[0], to[1], …; NaN where undefined. Returns whether all are defined.
  bool sample(const SparseField& field, float* to) const;

  /// The reasons that the mask, where there is one, gives at those of the eight voxels where some component of the
  /// field is undefined, and Reason::outside where one is inactive: bits of Reason.
  std::uint32_t reasons(const SparseField& field, const Mask* mask) const;

 private:
  struct Node {
    std::size_t leaf;
    int offset;
    double weight;
  };
  template <std::size_t n>
  struct Nodes {
    std::array<Node, n> node;
    bool active = false;  ///< all of them
  };
  template <std::size_t n>
  void find(const Coord& first, const std::array<std::array<double, n>, 3>& weights, Nodes<n * n * n>& to);

  const Lattice& lattice_;
  const Topology& topology_;
  const LeafIndex& index_;
  Interpolation interpolation_;
  Nodes<8> eight_;
  Nodes<64> many_;  ///< of tricubic interpolation
};

}  // namespace grainvdb
