#pragma once
/// Where fields are wanted, when not everywhere: sets of leaves.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "grainvdb/lattice.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Either a box of voxels or a list of leaves. Both count as all leaves that they touch, but when a topology is
/// clipped.
class Region {
 public:
  /// The voxels whose index lies in [first, last] along each axis, images included.
  static Region box(const Lattice& lattice, const Coord& first, const Coord& last);
  /// The voxels whose centres x lie in lo ≤ x < hi [length], images included; infinite sides are open. Nothing when
  /// there is no such voxel.
  static Region box(const Lattice& lattice, const Vec3& lo, const Vec3& hi);
  /// Leaves of the stored period by their origins, in any order.
  static Region leaves(std::vector<Coord> origins);

  bool empty() const;
  /// Whether it touches the leaf.
  bool holds(const Coord& leaf) const;

  /// The leaf-sized cells with a point within `voxels` of one of the leaves, along every axis, images not wrapped.
  Region grown(double voxels) const;
  /// The leaves of the stored period that hold an image of one of the voxels.
  Region wrapped(const Lattice& lattice) const;
  /// All leaves along some axes.
  Region everywhere_along(std::array<bool, 3> axes) const;

  /// Those of a topology's voxels that are wanted: voxel by voxel for a box.
  Topology clip(const Topology& topology) const;
  /// The smallest box about those of a box of voxels that are wanted, if there are any.
  std::optional<Topology::Bounds> clip(const Topology::Bounds& bounds) const;

 private:
  using Interval = std::pair<std::int64_t, std::int64_t>;  // first and last voxel
  using Box = std::array<std::vector<Interval>, 3>;        // of each axis: ascending, apart
  using List = std::vector<Coord>;                         // ascending

  explicit Region(std::variant<Box, List> what) : what_(std::move(what)) {}
  static std::vector<Interval> wrapped(const Lattice& lattice, int axis, const std::vector<Interval>& intervals);

  std::variant<Box, List> what_;
};

}  // namespace grainvdb
