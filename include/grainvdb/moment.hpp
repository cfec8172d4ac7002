#pragma once
/// Moments: the additive quantities that are splatted per frame and averaged over time. Fields are formed from their
/// averages afterwards (physics section 1: first average what adds, then form ratios).
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

class FrameView;
struct Moment;
using MomentPtr = std::shared_ptr<const Moment>;

/// How the line integral of W along a half branch of a contact is evaluated.
struct LineIntegral {
  enum class Method {
    adaptive,           ///< as few points as keep the error of every half branch within 3e-5 W(0)
    exact,              ///< closed form, in double precision
    gauss,              ///< Gauss-Legendre rule
    midpoint_curvature  ///< one point and the second derivative there, on parts of at most longest_curved_branch
  };
  Method method = Method::adaptive;
  int gauss_points = 0;  ///< 1 … 8 for Method::gauss

  static constexpr LineIntegral adaptive() { return {}; }
  static constexpr LineIntegral exact() { return {Method::exact, 0}; }
  static constexpr LineIntegral gauss(int points) { return {Method::gauss, points}; }
  static constexpr LineIntegral midpoint_curvature() { return {Method::midpoint_curvature, 0}; }
  bool operator==(const LineIntegral&) const = default;
};

/// Which of a frame's half branches a moment of contacts sums over.
enum class BranchKind {
  all,            ///< both of every contact of two grains, one of every contact with a wall that is no grain
  outside_walls,  ///< those that do not lie in a wall grain
  at_walls  ///< one for each contact of material with a wall grain or another wall: at the contact point, with the
            ///< force on the material and an arm of length zero
};

/// The channels of Moment::Kind::second_moments at a voxel x, with r = x_α - x the place of a particle (or of the image
/// of it that the kernel reaches) about the voxel. From them Σ w (v - a - L r)(v - a - L r) W follows for any a and L.
/// Sums are exact to 1e-5 (about 1e-6 in practice) of the sums of the terms' magnitudes with v measured from the mean
/// velocity around the voxel's leaf, however large that is.
struct SecondMoments {
  static constexpr std::size_t weight = 0;           ///< Σ w W
  static constexpr std::size_t velocity = 1;         ///< Σ w v_i W, at + i
  static constexpr std::size_t place = 4;            ///< Σ w r_j W, at + j
  static constexpr std::size_t velocity_square = 7;  ///< Σ w v_i v_j W, at + pair(i, j)
  static constexpr std::size_t velocity_place = 13;  ///< Σ w v_i r_j W, at + 3 i + j
  static constexpr std::size_t place_square = 22;    ///< Σ w r_i r_j W, at + pair(i, j)
  static constexpr std::size_t channels = 28;

  /// xx xy xz yy yz zz of a symmetric tensor are 0 … 5.
  static constexpr std::size_t pair(std::size_t i, std::size_t j) {
    constexpr std::size_t at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    return at[i][j];
  }
};

/// One additive quantity of `channels` numbers per voxel. Moments of the same name are the same moment: a name must
/// tell apart what differs by an option.
struct Moment {
  enum class Kind {
    particles,           ///< Σ_α q_α W(x - x_α), q from `values`
    particle_gradients,  ///< Σ_α q_α ∂_j W(x - x_α), three channels (j) per value of q
    second_moments,      ///< the channels of SecondMoments, from q = w, w v
    particle_squares,    ///< Σ_α q_α W(x - x_α)²
    contacts,            ///< Σ over half branches of q ∫₀¹ W(x - x_α + s a) ds
    voxels               ///< a function of other moments of the same frame at the same voxel
  };

  std::string name;
  Kind kind = Kind::particles;
  int channels = 1;     ///< per voxel; for particle_gradients three times the number of values per particle
  ColumnSet columns{};  ///< what must be read for it
  std::vector<MomentPtr>
      frame_needs{};  ///< moments of the same frame that must be complete before: one more pass over the particles
  std::vector<MomentPtr>
      mean_needs{};                  ///< moments whose time mean must be known before: one more sweep over the frames
  std::array<bool, 3> whole_axes{};  ///< along these the frame_needs are needed everywhere, not near the particles only
  BranchKind branch_kind = BranchKind::all;  ///< for contacts
  /// The number of the species (Pipeline::species) whose particles, or half branches, it sums over and `values` sees.
  std::optional<int> species{};
  LineIntegral line_integral{};  ///< for contacts

  /// For sums Σ w q W whose mean is taken off later: the moment Σ w W. The splat then sums w (q - r) with a local
  /// reference r of q, in which single precision loses nothing.
  MomentPtr weight{};
  /// For sums whose small differences are fields: added up in double precision throughout.
  bool in_double = false;

  /// Fills q for every particle (or half branch) of the view, laid out [entry][value].
  std::function<void(const FrameView& view, std::span<double> q)> values{};

  /// For Kind::voxels: `in` are the channels of frame_needs one after another, `out` this moment's channels; each
  /// points to the leaf_size values of one leaf.
  std::function<void(std::span<const double* const> in, std::span<double* const> out)> voxels{};

  /// Values per particle or half branch.
  int value_count() const {
    if (kind == Kind::second_moments) return 4;
    return kind == Kind::particle_gradients ? channels / 3 : channels;
  }
};

/// A half branch of a contact: from the particle's centre towards the contact point. a = x_α - c is centre minus
/// contact point (physics eq. 8), so the points of the branch are x_α - s a, 0 ≤ s ≤ 1.
struct HalfBranches {
  Columns3 start;              ///< x_α [length]
  Columns3 arm;                ///< a_αβ [length]
  Columns3 force;              ///< F_αβ, the force on α [force]
  std::vector<int> species{};  ///< of α: its number in Pipeline::species, -1: none; empty where there are no species
  std::size_t size() const { return start[0].size(); }
};

/// A frame as the moments see it: the material particles, the half branches that moments sum over, and fields of this
/// frame or of the time mean sampled at the particles. Moments of a species see its own alone; the fields are those of
/// all material.
class FrameView {
 public:
  virtual ~FrameView() = default;

  /// The particles that count as material, in ascending order of id.
  virtual const Particles& particles() const = 0;
  virtual const HalfBranches& branches(BranchKind set) const = 0;

  /// numerator/denominator formed at the voxels, then interpolated trilinearly to every particle: the three channels of
  /// `numerator` over the single channel of `denominator`, both among the moment's frame_needs (`interpolate_frame`)
  /// or mean_needs (`interpolate_mean`).
  virtual std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator) const = 0;
  virtual std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator) const = 0;

  /// How much of the variance of independent particle values is left in their deviations from interpolate_frame with
  /// this denominator, at every particle: Σ_β (δ_αβ - w_αβ)², w_αβ the share of particle β in the value at α.
  virtual std::vector<double> deviation_factors(const Moment& denominator) const = 0;

  /// The same with both moments summed over the `homogeneous` axes first, and linear interpolation along the others.
  virtual std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                      std::array<bool, 3> homogeneous) const = 0;
};

/// V = 4/3 π r³.
double sphere_volume(double radius);

}  // namespace grainvdb
