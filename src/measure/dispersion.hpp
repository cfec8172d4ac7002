#pragma once
/// How grains spread among each other: variances of their displacements, followed by id.
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/counted_region.hpp"
#include "measure/fluctuations.hpp"
#include "measure/slabs.hpp"

namespace grainvdb {

/// Half the growth of a variance, with its standard error.
struct Diffusivity {
  double value = 0;
  double error = 0;
};

/// Displacements of the grains that are in the counted region when a window of frames begins and are there in each
/// frame since. They are sums of steps between successive frames, each by its nearest image, so that grains may cross
/// periodic boundaries any number of times.
class Dispersion {
 public:
  /// Windows have `lags` steps, then the next begins; 0: one window of all frames.
  Dispersion(const CountedRegion& region, std::size_t lags) : region_(region), lags_(lags) {}

  /// The next frame. Where it has velocities and times, a step along a periodic axis that velocity × time of a grain
  /// that is followed says may be longer than half the box is refused, for its nearest image may be another: the window
  /// ends before it.
  void add(const Frame& frame, const MeanMotion& motion);

  std::size_t lags() const { return sums_.size(); }
  std::size_t refused_steps() const { return refused_; }

  /// Means over windows, of lag k + 1.
  double time(std::size_t k) const;       ///< NaN where frames have none [time]
  double travelled(std::size_t k) const;  ///< length of the mean displacement [length]
  double grains(std::size_t k) const;     ///< all windows together
  /// Variance of the displacement along an axis about the mean motion [length²].
  double variance(std::size_t k, std::size_t axis) const { return variance(k, axis, Slabs::count); }

  enum class Against { time, travelled };
  /// Half the slope of the variance against time, or against the way travelled: the diffusivity D [length²/time], or
  /// the diffusion length b [length]. A least-squares line with an intercept, for steps that are not yet independent,
  /// through the lags that begin `from` [time]; through the origin where there is only one. NaN where there is none.
  Diffusivity diffusivity(std::size_t axis, Against against, double from) const;

 private:
  struct Sums {
    std::array<std::array<double, 3>, Slabs::count> squares{};
    std::array<double, Slabs::count> grains{};
    double time = 0, travelled = 0, windows = 0;
  };
  void begin(const Frame& frame);
  void take_step(const Frame& frame);
  void record(const Frame& frame, const MeanMotion& motion);
  bool is_too_long(const Frame& frame) const;
  Vec3 largest_speeds(const Frame& frame) const;  ///< along each axis, of the grains that are followed
  double variance(std::size_t k, std::size_t axis, std::size_t without) const;
  double half_slope(std::size_t axis, Against against, double from, std::size_t without) const;

  CountedRegion region_;
  std::size_t lags_, lag_ = 0, refused_ = 0;
  std::optional<Slabs> slabs_;
  std::vector<Sums> sums_;
  std::optional<double> start_time_;
  // The grains that are followed: ids ascending, where they started, where they were last, and how far they came.
  std::vector<std::int64_t> id_;
  Columns3 start_, last_, moved_;
  std::optional<double> last_time_;
  Vec3 last_speeds_{};
  bool has_speeds_ = false, follows_ = false;
};

}  // namespace grainvdb
