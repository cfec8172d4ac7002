#pragma once
/// Fields of a species by their names.
#include <string>

#include "grainvdb/stage.hpp"

namespace grainvdb {

/// What a name such as "phi_small" is made of. A field of all grains is of no species.
struct PartialField {
  const Stage* all = nullptr;  ///< the field of all grains; nullptr where there is none that has such a part
  std::string species{};

  /// What is behind the names of fields of the same grains: "_small", or nothing.
  std::string suffix() const { return species.empty() ? species : '_' + species; }
};

PartialField partial_field(const std::string& name);

}  // namespace grainvdb
