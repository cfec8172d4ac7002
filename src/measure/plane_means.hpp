#pragma once
/// Averages over whole planes straight from the particles, with the kernel integrated over the plane.
#include <cstdint>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

/// Sums of one frame over each plane of voxel centres, divided by the plane's area: Σ q w₁(z - z_α)/A, w₁ = ∫∫W dx dy.
struct PlaneMeans {
  enum Channel { volume, mass, momentum_x, momentum_y, momentum_z, diameter, heat, channels };

  std::int32_t first = 0;      ///< voxel index of the first plane
  std::vector<double> values;  ///< [plane][channel]: Σ V, m, V v (three), V d and V|v-u(z_α)|², each times w₁/A
  std::size_t planes() const { return values.size() / channels; }
  double value(std::size_t plane, Channel c) const { return values[plane * channels + c]; }
};

/// u(z) = Σ V v w₁/Σ V w₁ is that of the frame, between planes the linear interpolation of momentum and volume apart,
/// as the mode two_pass_profile of the temperature takes it. `area` of the planes [length²].
PlaneMeans plane_means(const Particles& particles, const Lattice& lattice, const LucyKernel& kernel, int axis,
                       double area);

}  // namespace grainvdb
