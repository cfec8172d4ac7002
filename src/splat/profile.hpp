#pragma once
/// Sums over planes: the splat of a flow that does not vary along two axes, with the kernel integrated over them.
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

/// Sums at the voxel centres along one axis, from voxel `first` on.
struct PlaneSums {
  std::int32_t first = 0;
  int channels = 0;
  std::vector<double> values;  ///< [plane][channel]

  std::size_t planes() const { return values.size() / static_cast<std::size_t>(channels); }
  double value(std::size_t plane, int channel) const {
    return values[plane * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)];
  }
};

/// Σ_α q_α w₁(z - z_α) at the planes that any particle reaches, w₁ = ∫∫ W dx dy the kernel's marginal (physics
/// section 2) [q/length]: divided by the area of the planes it is the exact average of Σ q W over them. `q` is laid out
/// [point][channel]. Exact to 1e-5 of Σ |q| w₁ at every plane; the same for any number of threads. Throws
/// std::invalid_argument when q has another size, or a position does not fit the voxel index range.
PlaneSums splat_planes(const Lattice& lattice, const LucyKernel& kernel, int axis, const std::vector<double>& position,
                       std::span<const double> q, int channels);

}  // namespace grainvdb
