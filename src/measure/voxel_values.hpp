#pragma once
/// The values of fields voxel by voxel, as measurements read them.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

struct OutputFields;

/// Calls f(voxel, values) for every active voxel in ascending order of leaves, then of voxels. `values` are all
/// components of the named fields one after another; NaN where undefined.
void for_each_value(const OutputFields& fields, const std::vector<std::string>& names,
                    const std::function<void(const Coord&, std::span<const double>)>& f);

/// How many independent values a voxel counts for, at most 1: h³ ∫W² dV. What is uncorrelated in space keeps, smoothed
/// by W, a correlation of integral 1/∫W² dV, with ∫W² dV = 455/(176 π c³).
double independence(double voxel, const LucyKernel& kernel);

}  // namespace grainvdb
