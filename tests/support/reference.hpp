#pragma once
/// The coarse-grained fields of physics section 3 by brute force, from the formulas alone.
#include <map>
#include <string>
#include <vector>

#include "grainvdb/pipeline.hpp"
#include "support/kernel_sums.hpp"
#include "support/uncertain.hpp"
#include "support/voxel_box.hpp"

namespace grainvdb::testing {

/// How exactly sums are formed by the program, relative to Σ |terms|: its particle kernel works in single precision and
/// is held to 1e-5 at every voxel by its own tests. Errors are about 1e-6; the largest that was met, near the rim of
/// the supports in adversarial scenes, is 7.1e-6. (Storing in a float grid comes on top.)
inline constexpr double sum_rounding = 7.1e-6;
/// The same for sums over contacts with line_integral: exact, which are formed in double: a thousand terms and a few
/// roundings each stay below 1000 × 2⁻⁵² = 2.2e-13, and the quadrature of the reference's line integrals is good to
/// about that as well.
inline constexpr double contact_sum_rounding = 1e-12;
/// And with Gauss rules, which are summed in single precision: held to 1e-5 by their own tests, which find errors up to
/// 8e-6 where only a few branches reach a voxel, with the rims of their supports.
inline constexpr double gauss_sum_rounding = 9.9e-6;
/// What is asked of every field on float grids: error ≤ 1e-5 Σ |terms|.
static_assert(float_rounding + sum_rounding <= 1e-5 && float_rounding + gauss_sum_rounding <= 1e-5);

/// A field, laid out [voxel][component]; NaN where it is undefined.
struct ReferenceField {
  int components = 1;
  std::vector<double> value;
  std::vector<double> magnitude;   ///< Σ |terms| of the numerator over the denominator
  std::vector<double> floor;       ///< error from rounding inside the terms, absolute
  double rounding = sum_rounding;  ///< error of the sums, relative to the magnitude

  std::size_t index(std::size_t voxel, int component) const {
    return voxel * static_cast<std::size_t>(components) + static_cast<std::size_t>(component);
  }
  /// The value with the error that computing in double and storing as float may leave.
  Uncertain expected(std::size_t voxel, int component = 0) const;
};

struct Reference {
  VoxelBox box;
  std::vector<int> particle_frames;  ///< frames in which a particle's kernel reached the voxel
  std::vector<int> any_frames;       ///< the same for particles or contacts
  /// phi, density, velocity, mean_diameter, angular_velocity, temperature, rotational_fluctuation, contact_stress,
  /// kinetic_stress, gradient_by_kernel, and the shares of the variance that temperature and rotational_fluctuation
  /// were divided by, temperature_share and rotational_fluctuation_share. In mode one_pass_corrected the gradient part
  /// is still in them.
  std::map<std::string, ReferenceField> fields;
};

/// Averages over the frames as one window, with the options and the selection of the pipeline.
Reference coarse_grain(const std::vector<Frame>& frames, const Pipeline& pipeline);

/// The particles of a frame that the selection keeps.
Particles material(const Frame& frame, const Selection& selection);

/// numerator/denominator at the voxels, interpolated trilinearly, periodic.
std::vector<Vec3> interpolate(const VoxelBox& box, const Sums& numerator, const Sums& denominator,
                              const Columns3& position);
/// Σ_j (δ_ij - w_ij)² at every particle i, w_ij the share that particle j has in a ratio of sums of weight × value over
/// `denominator`, the sum of weights, interpolated so.
std::vector<double> deviation_factors(const VoxelBox& box, double cutoff, const std::vector<double>& weight,
                                      const Sums& denominator, const Columns3& position);
/// The same with both summed over the homogeneous axes first.
std::vector<Vec3> interpolate_profile(const VoxelBox& box, const Sums& numerator, const Sums& denominator,
                                      const Columns3& position, std::array<bool, 3> homogeneous);

}  // namespace grainvdb::testing
