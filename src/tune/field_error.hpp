#pragma once
/// The distance of a run's fields from those of a reference on another lattice.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/lattice.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/tune.hpp"

namespace grainvdb {

/// The fields of a run, by name, all on one topology.
struct FieldSet {
  Lattice lattice;
  std::map<std::string, SparseField> fields;
};

/// Voxel centres of the reference, with its values there.
struct ReferencePoints {
  std::vector<Vec3> position;
  std::vector<double> weight;  ///< of ratios; sums such as phi and stress weigh alike everywhere
  struct Field {
    std::string name;
    int components = 1;
    bool is_ratio = false;
    std::vector<float> values;  ///< [point][component]
  };
  std::vector<Field> fields;
};

/// The fields of these names at no more than `most` of the active voxels, which are picked by a hash of their
/// coordinates, so that no direction is favoured. `weight` names the field that ratios are weighted with; 1 when empty.
ReferencePoints reference_points(const FieldSet& reference, const std::vector<std::string>& names,
                                 const std::string& weight, std::size_t most);

/// Compares the fields of the reference with those of the same name, interpolated trilinearly to its points. A point
/// has no value where one of the voxels that carry weight is undefined; sums such as phi are zero at inactive voxels. A
/// field that the run does not have is undefined everywhere.
std::vector<FieldError> field_errors(const ReferencePoints& reference, const FieldSet& found);

}  // namespace grainvdb
