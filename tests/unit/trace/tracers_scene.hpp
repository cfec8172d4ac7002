#pragma once
/// Single tracers.
#include <vector>

#include "grainvdb/tracers.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::testing {

inline const Lattice unit_lattice(1, {0, 0, 0});

inline Vec3 position(const Tracers& tracers, std::size_t i = 0) {
  const Columns3& x = tracers.state().position;
  return {x[0][i], x[1][i], x[2][i]};
}

inline TracerSeeds seed(const Vec3& x) {
  return seeds_at(std::vector<Vec3>{x});
}

}  // namespace grainvdb::testing
