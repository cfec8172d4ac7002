#pragma once
/// The derived fields of physics section 4, from the formulas alone, each value with the error that rounding of its
/// inputs and of the fields in between may leave, and the reasons why values are undefined.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "grainvdb/mask.hpp"
#include "grainvdb/pipeline.hpp"
#include "support/uncertain.hpp"
#include "support/voxel_box.hpp"

namespace grainvdb::testing {

/// Values laid out [voxel][component].
struct UncertainField {
  int components = 1;
  std::vector<Uncertain> values;
  const Uncertain& at(std::size_t voxel, int component = 0) const {
    return values[voxel * static_cast<std::size_t>(components) + static_cast<std::size_t>(component)];
  }
};
using UncertainFields = std::map<std::string, UncertainField>;

struct Derived {
  UncertainFields fields;
  std::vector<std::uint32_t> mask;
  /// Bits that the error leaves in doubt, because a threshold lies within it. Values that hang on them are not checked:
  /// they are `in_doubt`.
  std::vector<std::uint32_t> unsure;
};

/// A value that may be undefined or not: a threshold lies within the error.
Uncertain in_doubt();
bool is_in_doubt(const Uncertain& a);

/// From phi, density, velocity, angular_velocity, mean_diameter, temperature, rotational_fluctuation, the shares of the
/// variance in these two, and stress at the active voxels, and velocity_gradient and angular_velocity_gradient where
/// they are formed by kernel gradients. Gives the gradients (central), temperature and rotational_fluctuation (where
/// they are one_pass_corrected) and all fields made of these. no_material is where phi is not positive.
Derived derive(const VoxelBox& box, const std::vector<bool>& active, const UncertainFields& base,
               const Pipeline& pipeline);

}  // namespace grainvdb::testing
