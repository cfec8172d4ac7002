#pragma once
/// Moments: the additive quantities that are splatted per frame and averaged over time. Fields are formed from their
/// averages afterwards (physics section 1: first average what adds, then form ratios).
#include <functional>
#include <memory>
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
    adaptive,  ///< as few points as keep the error of every half branch within 3e-5 W(0)
    exact,     ///< closed form, in double precision
    gauss      ///< Gauss-Legendre rule
  };
  Method method = Method::adaptive;
  int gauss_points = 0;  ///< 1 … 8 for Method::gauss

  static constexpr LineIntegral adaptive() { return {}; }
  static constexpr LineIntegral exact() { return {Method::exact, 0}; }
  static constexpr LineIntegral gauss(int points) { return {Method::gauss, points}; }
  bool operator==(const LineIntegral&) const = default;
};

/// One additive quantity of `channels` numbers per voxel. Moments of the same name are the same moment: a name must
/// tell apart what differs by an option.
struct Moment {
  enum class Kind {
    particles,           ///< Σ_α q_α W(x - x_α), q from `values`
    particle_gradients,  ///< Σ_α q_α ∂_j W(x - x_α), three channels (j) per value of q
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
      mean_needs{};              ///< moments whose time mean must be known before: one more sweep over the frames
  LineIntegral line_integral{};  ///< for contacts

  /// For sums Σ w q W whose mean is taken off later: the moment Σ w W. The splat then sums w (q - r) with a local
  /// reference r of q, in which single precision loses nothing.
  MomentPtr weight{};
  /// For sums whose small differences are fields: added up in double precision throughout.
  bool in_double = false;

  /// Fills q for every material particle (or half branch), laid out [entry][value].
  std::function<void(const FrameView& view, std::span<double> q)> values{};

  /// For Kind::voxels: `in` are the channels of frame_needs one after another, `out` this moment's channels; each
  /// points to the leaf_size values of one leaf.
  std::function<void(std::span<const double* const> in, std::span<double* const> out)> voxels{};

  int value_count() const { return kind == Kind::particle_gradients ? channels / 3 : channels; }
};

/// A half branch of a contact: from the particle's centre towards the contact point. a = x_α - c is centre minus
/// contact point (physics eq. 8), so the points of the branch are x_α - s a, 0 ≤ s ≤ 1.
struct HalfBranches {
  Columns3 start;  ///< x_α [length]
  Columns3 arm;    ///< a_αβ [length]
  Columns3 force;  ///< F_αβ, the force on α [force]
  std::size_t size() const { return start[0].size(); }
};

/// A frame as the moments see it: the material particles, the half branches, and fields of this frame or of the time
/// mean sampled at the particles.
class FrameView {
 public:
  virtual ~FrameView() = default;

  /// The particles that count as material, in ascending order of id.
  virtual const Particles& particles() const = 0;
  virtual const HalfBranches& branches() const = 0;

  /// numerator/denominator formed at the voxels, then interpolated trilinearly to every particle: the three channels of
  /// `numerator` over the single channel of `denominator`, both among the moment's frame_needs (`interpolate_frame`)
  /// or mean_needs (`interpolate_mean`).
  virtual std::vector<Vec3> interpolate_frame(const Moment& numerator, const Moment& denominator) const = 0;
  virtual std::vector<Vec3> interpolate_mean(const Moment& numerator, const Moment& denominator) const = 0;

  /// The same with both moments summed over the `homogeneous` axes first, and linear interpolation along the others.
  virtual std::vector<Vec3> interpolate_frame_profile(const Moment& numerator, const Moment& denominator,
                                                      std::array<bool, 3> homogeneous) const = 0;
};

/// V = 4/3 π r³.
double sphere_volume(double radius);

}  // namespace grainvdb
