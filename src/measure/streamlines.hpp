#pragma once
/// Lines along a vector field, by the way along them.
#include <cstddef>
#include <span>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

struct Streamline {
  std::vector<Vec3> points;  ///< unwrapped, a step apart: the n-th at the way n · step [length]
};

/// Follows the directions of a field of three components from each start, in steps of `step` > 0 over `length`, by the
/// classic Runge-Kutta method of order 4 on unit vectors that are interpolated linearly between voxels. A line ends
/// where the field is undefined, zero, or leaves the box, and has no point where it does not even start.
std::vector<Streamline> streamlines(const Lattice& lattice, const Box& box, const SparseField& field,
                                    std::span<const Vec3> starts, double step, double length);

}  // namespace grainvdb
