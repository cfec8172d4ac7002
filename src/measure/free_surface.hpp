#pragma once
/// The free surface of a bed of grains: the tops of columns, and a plane through them.
#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/counted_region.hpp"

namespace grainvdb {

/// A plane h = h₀ + s₀ x₀ + s₁ x₁ over the two horizontal axes, fitted by least squares. Along periodic axes, where the
/// surface can have no slope in the mean, s = 0 is not fitted.
struct SurfacePlane {
  double height = 0, height_error = 0;           ///< in the middle of the columns [length]
  std::array<double, 2> slope{}, slope_error{};  ///< along the horizontal axes, in cyclic order after the vertical one
  double angle = 0, angle_error = 0;             ///< atan √(s₀² + s₁²), from the horizontal [rad]
  double roughness = 0;                          ///< standard deviation of the tops about the plane [length]
  std::size_t columns = 0;
};

/// Columns of square base across the vertical axis. The top of each is that of its highest grain z + r, at that grain's
/// place, so that no place within the column need be chosen.
class FreeSurface {
 public:
  /// `width` of columns > 0 [length].
  FreeSurface(std::size_t vertical, double width) : vertical_(vertical), width_(width) {}

  /// The grains of one frame that make up the bed.
  void add(const Box& box, const Columns3& position, const std::vector<double>& radius);

  /// Through the tops, each column's the mean of the frames that have it. Errors take columns as independent. NaN where
  /// there are too few columns to fit.
  SurfacePlane plane() const;

 private:
  struct Top {
    Vec3 at{};  ///< place and height
    double frames = 0;
  };
  std::size_t vertical_;
  double width_;
  std::array<bool, 2> sloped_{};
  std::map<std::pair<long, long>, Top> tops_;
};

/// Which grains have at least `least` others with centres within `reach` of theirs: not those in flight above a bed.
std::vector<bool> supported(const Box& box, const Columns3& position, double reach, std::size_t least);

}  // namespace grainvdb
