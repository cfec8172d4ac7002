#pragma once
/// A named field on OpenVDB grids: one FloatGrid per component, all fields of a result on one topology.
/// This header keeps OpenVDB out of the way; grids.hpp gives access to the grids themselves.
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/lattice.hpp"
#include "grainvdb/topology.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

/// What a field is, apart from its values.
struct FieldMeta {
  std::string name;         ///< as in the field table, e.g. "contact_stress"
  std::string unit;         ///< e.g. "Pa"; "1" for pure numbers
  int components = 1;       ///< 1, 3 (vector), 6 (two vectors) or 9 (row-major tensor ij)
  std::string description;  ///< one line
  std::string equation;     ///< formula with its tag, e.g. "Σ V W (6)"
  float background = 0.0F;  ///< value where no kernel reaches: 0 for sums such as phi, NaN for ratios such as velocity
  Dimension dimension{};    ///< of the values
};

class SparseField {
 public:
  /// All values start at the background.
  SparseField(FieldMeta meta, std::shared_ptr<const Topology> topology, const Lattice& lattice);
  /// A field whose values are not set: every leaf has to be written whole, all its 512 values, before anything reads
  /// it. Saves writing large fields twice.
  static SparseField unset(FieldMeta meta, std::shared_ptr<const Topology> topology, const Lattice& lattice);
  ~SparseField();
  SparseField(SparseField&&) noexcept;
  SparseField& operator=(SparseField&&) noexcept;

  const FieldMeta& meta() const { return meta_; }
  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  int components() const { return meta_.components; }

  /// The 512 values of a component in a leaf, in OpenVDB's order (see leaf_offset).
  float* leaf(std::size_t leaf, int component = 0) {
    return leaves_[leaf * components_() + static_cast<std::size_t>(component)];
  }
  const float* leaf(std::size_t leaf, int component = 0) const {
    return leaves_[leaf * components_() + static_cast<std::size_t>(component)];
  }
  /// All components of a leaf.
  std::span<float* const> components_of(std::size_t leaf) {
    return {leaves_.data() + leaf * components_(), components_()};
  }
  /// The value at a voxel, the background outside the topology. For tests and look-ups, not for loops.
  float value(const Coord& c, int component = 0) const;

  /// Goes over to another unit, in place: values are divided by `size`, its size in the unit of before, in double
  /// precision. The grids come to lie on `lattice`, which has the same voxels. Throws std::invalid_argument where the
  /// background would change.
  void change_units(double size, std::string unit, const Lattice& lattice);

  /// Owner of the OpenVDB grids; see grids.hpp.
  struct Grids;
  const Grids& grids() const { return *grids_; }

 private:
  SparseField(FieldMeta meta, std::shared_ptr<const Topology> topology);
  std::size_t components_() const { return static_cast<std::size_t>(meta_.components); }
  FieldMeta meta_;
  std::shared_ptr<const Topology> topology_;
  std::unique_ptr<Grids> grids_;
  std::vector<float*> leaves_;
};

}  // namespace grainvdb
