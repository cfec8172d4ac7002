#pragma once
/// Why a field has no value at a voxel. A voxel may carry several reasons; a field is NaN wherever one of its own
/// applies.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "grainvdb/topology.hpp"

namespace grainvdb {

enum class Reason : std::uint32_t {
  outside = 1u << 0,              ///< no kernel reaches the voxel
  no_material = 1u << 1,          ///< φ = 0: reached by contacts only; velocity, diameter, temperature, … undefined
  low_pressure = 1u << 2,         ///< P ≤ pressure_floor: μ, I, g, gd/δv undefined
  no_shear_stress = 1u << 3,      ///< μ = |σ|/P ≤ its minimum (isotropic to rounding): g = |γ̇|/μ undefined
  no_fluctuation = 1u << 4,       ///< T ≤ T_min or within the rounding of velocities: gd/δv undefined
  no_spin_fluctuation = 1u << 5,  ///< δω² ≤ its minimum or within rounding: g/δω, δv/(d δω) undefined
  one_sided_gradient =
      1u << 6,  ///< a neighbour along an axis is missing: that derivative is one-sided (a value, less accurate)
  no_gradient = 1u << 7,             ///< both neighbours along an axis are missing: gradient undefined
  degenerate_stress_axes = 1u << 8,  ///< principal stresses closer than the gap: axes undefined
  degenerate_strain_axes =
      1u << 9,                ///< principal strain rates closer than the gap, or no shearing: coaxiality undefined
  tensile_stress = 1u << 10,  ///< a principal stress is tensile or zero: Mohr-Coulomb ratio undefined
  negative_temperature = 1u << 11,  ///< the gradient part exceeds the one-pass variance: no T, no δω²
  lone_particles = 1u << 12,        ///< particles are their own mean: T, δω² without self-weight undefined
  few_blocks = 1u << 13,            ///< undefined without one of the blocks of frames: its standard error undefined
  behind_wall = 1u << 14,           ///< the centre of the voxel lies behind a wall: every field undefined
  near_wall = 1u << 15,             ///< the kernel comes nearer to a wall than walls.clearance: every field undefined
  no_stress_gradient = 1u << 16,    ///< the stress is missing on both sides along an axis: its gradient undefined
  no_species = 1u << 17,            ///< no grain of a species reaches the voxel: its velocity, diameter, … undefined
};

struct ReasonInfo {
  Reason reason;
  std::string_view name;
  std::string_view meaning;
};
/// All reasons in order of their bits.
const std::vector<ReasonInfo>& reasons();

/// The reasons at every voxel of a topology, laid out [leaf][offset in leaf].
class Mask {
 public:
  explicit Mask(std::shared_ptr<const Topology> topology)
      : topology_(std::move(topology)), bits_(topology_->leaf_count() * leaf_size) {}
  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  void add(std::size_t leaf, int offset, Reason r) {
    bits_[leaf * leaf_size + static_cast<std::size_t>(offset)] |= static_cast<std::uint32_t>(r);
  }
  const std::uint32_t* leaf(std::size_t leaf) const { return bits_.data() + leaf * leaf_size; }
  /// The number of active voxels that carry the reason.
  std::size_t count(Reason r) const;

 private:
  std::shared_ptr<const Topology> topology_;
  std::vector<std::uint32_t> bits_;
};

}  // namespace grainvdb
