#include "grainvdb/mask.hpp"

namespace grainvdb {

const std::vector<ReasonInfo>& reasons() {
  static const std::vector<ReasonInfo> all{
      {Reason::outside, "outside", "no kernel reaches the voxel"},
      {Reason::no_material, "no_material", "phi = 0: no material particle within the cutoff"},
      {Reason::low_pressure, "low_pressure", "P <= pressure_floor: ratios to the pressure undefined"},
      {Reason::no_shear_stress, "no_shear_stress", "|sigma|/P <= its minimum: fluidity undefined"},
      {Reason::no_fluctuation, "no_fluctuation",
       "temperature <= its minimum or within rounding: ratios to it undefined"},
      {Reason::no_spin_fluctuation, "no_spin_fluctuation",
       "spin fluctuation <= its minimum or within rounding: ratios to it undefined"},
      {Reason::one_sided_gradient, "one_sided_gradient", "a neighbour is missing: one-sided derivative, less accurate"},
      {Reason::no_gradient, "no_gradient", "both neighbours along an axis are missing: gradient undefined"},
      {Reason::degenerate_stress_axes, "degenerate_stress_axes", "principal stresses too close: axes undefined"},
      {Reason::degenerate_strain_axes, "degenerate_strain_axes", "principal strain rates too close: axes undefined"},
      {Reason::tensile_stress, "tensile_stress", "a principal stress is not compressive: Mohr-Coulomb ratio undefined"},
      {Reason::negative_temperature, "negative_temperature",
       "gradient part exceeds the one-pass variance: no T, no dw^2"},
      {Reason::lone_particles, "lone_particles", "particles are their own mean: no fluctuation without self-weight"},
      {Reason::few_blocks, "few_blocks", "no value without one of the blocks of frames: standard error undefined"},
      {Reason::behind_wall, "behind_wall", "the centre of the voxel lies behind a wall"},
      {Reason::near_wall, "near_wall", "the kernel comes nearer to a wall than the clearance"},
      {Reason::no_stress_gradient, "no_stress_gradient",
       "the stress is missing on both sides along an axis: its gradient undefined"},
      {Reason::no_species, "no_species", "no grain of a species within the cutoff: its ratios undefined"},
  };
  return all;
}

std::size_t Mask::count(Reason r) const {
  std::size_t n = 0;
  for (std::size_t l = 0; l < topology_->leaf_count(); ++l)
    topology_->mask(l).for_each(
        [&](int offset) { n += (leaf(l)[offset] & static_cast<std::uint32_t>(r)) != 0 ? 1U : 0U; });
  return n;
}

}  // namespace grainvdb
