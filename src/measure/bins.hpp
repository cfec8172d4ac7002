#pragma once
/// Planes and cylindrical shells that voxels are averaged over.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/lattice.hpp"
#include "grainvdb/options.hpp"
#include "grainvdb/stage.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {

/// Which voxels are averaged together.
struct BinSpec {
  enum class Geometry { planes, shells };
  Geometry geometry = Geometry::planes;
  int axis = 2;             ///< the normal of the planes, the axis of the shells
  Vec3 centre{};            ///< a point of the axis of the shells [length]
  double from = 0;          ///< voxel centres below along the axis are left out [length] …
  double to = 0;            ///< … and those from here on; no bounds where from = to = 0
  double slab = 0;          ///< height of the slabs that shells are cut into [length]; 0: they are not
  double width = 0;         ///< of a bin [length]; 0: the voxel
  std::int64_t points = 0;  ///< voxels of a plane, √points along each of its axes; 0: all
};

/// axis, geometry, centre, from, to, bin, slab and points, as the measurements of profiles offer them.
std::vector<OptionInfo> bin_options();
BinSpec bin_spec(const OptionValues& options);
/// Refuses from ≥ to, both of which any measurement with heights has.
std::optional<OptionConflict> height_conflict(const OptionValues& options);
std::optional<OptionConflict> bin_conflict(const OptionValues& options);

/// Where a voxel belongs.
struct VoxelPlace {
  std::size_t leaf;
  int offset;
  std::int64_t bin;             ///< ascending with the height, within a slab with the distance from the axis
  double height;                ///< along the axis [length]
  double position;              ///< the height for planes, the distance from the axis for shells [length]
  double cosine = 1, sine = 0;  ///< of the angle from the axis after `axis` (y after x, z after y, x after z)
};

class Bins {
 public:
  Bins(const BinSpec& spec, const Lattice& lattice) : spec_(spec), lattice_(lattice) {}

  const BinSpec& spec() const { return spec_; }
  /// Calls f for every active voxel that belongs to a bin, leaf by leaf. A voxel centre on the axis of shells has no
  /// direction and belongs to none.
  void for_each(const Topology& topology, const std::function<void(const VoxelPlace&)>& f) const;

  /// Vectors (3 components, or 6: two of them) and tensors (9, row by row) in the directions of the bins: x, y, z for
  /// planes; r, θ, and the axis for shells. Scalars stay as they are.
  void rotate(const VoxelPlace& place, std::span<double> components) const;
  /// The names of the directions: "x", "y", "z" or "r", "theta" and the axis.
  std::array<std::string, 3> directions() const;

 private:
  /// The voxel indices along `axis` that hold the points.
  std::set<std::int32_t> point_indices(int axis, const Topology::Bounds& bounds) const;
  bool within(double height) const { return spec_.from == spec_.to || (height >= spec_.from && height < spec_.to); }
  std::optional<VoxelPlace> place(std::size_t leaf, int offset, const Coord& c) const;

  BinSpec spec_;
  Lattice lattice_;
};

}  // namespace grainvdb
