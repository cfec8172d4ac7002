#pragma once
/// Sums over planes that are formed in double precision, term by term.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "splat/profile.hpp"

namespace grainvdb {

/// What is summed over the planes normal to `axis`, at the voxel centres along it: straight from `start` to
/// `start` - `arm`, or points where there are no arms [length].
struct PlaneSources {
  const Lattice& lattice;
  const LucyKernel& kernel;
  int axis;
  const std::vector<double>& start;
  const std::vector<double>* arm = nullptr;
};

/// Whether the kernel reaches each plane from any of the entries, by voxel index from `first` on.
struct ReachedPlanes {
  std::int32_t first = 0;
  std::vector<char> reached;
};
ReachedPlanes reached_planes(const PlaneSources& entries);

// Each is laid out as its values, [entry][channel], and the same for any number of threads. Throws
// std::invalid_argument when q has another size.

/// Σ q w₁(z - z_α), as splat_planes in single precision.
PlaneSums sum_on_planes(const PlaneSources& points, std::span<const double> q, int channels);

/// Σ q w₁'(z - z_α).
PlaneSums sum_gradients_on_planes(const PlaneSources& points, std::span<const double> q, int channels);

/// Σ q ∫₀¹ w₁(z - z_α + s a) ds over half branches: by the antiderivative of w₁, a polynomial, to rounding.
PlaneSums sum_branches_on_planes(const PlaneSources& branches, std::span<const double> q, int channels);

/// The channels of SecondMoments from q = w, w v, laid out [point][4], with the place of a particle about the plane
/// along the axis. Places along the planes are left 0: nothing varies along these.
PlaneSums sum_second_moments_on_planes(const PlaneSources& points, std::span<const double> q);

}  // namespace grainvdb
