#pragma once
/// How much looser material is when it flows, and how fast what loosens it rises.
#include <cstddef>
#include <optional>
#include <vector>

#include "grainvdb/frame.hpp"
#include "measure/estimate.hpp"

namespace grainvdb {

/// Grains in a box, each with a weight that falls smoothly from 1 to 0 across the faces of it, over two mean diameters:
/// the number in the box then hardly depends on which layer of grains a face cuts. The integral of the weight is the
/// volume of the box. Along a periodic axis that the box fills there are no faces.
struct SmoothBox {
  Vec3 lo{}, hi{};  ///< [length]

  double volume() const { return (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]); }
  double weight(const Box& box, const Vec3& x, double diameter) const;
};

/// Number density and flux of grains in a box, at rest and in flow.
class Loosening {
 public:
  Loosening(const SmoothBox& box, std::size_t up) : box_(box), up_(up) {}

  /// The packing at rest, by a frame or by its packing fraction.
  void rest(const Frame& frame);
  void rest(double phi) { phi_at_rest_ = phi; }
  bool has_rest() const { return phi_at_rest_ || at_rest_; }
  /// A frame of the flow.
  void add(const Frame& frame);

  std::size_t frames() const { return density_.size(); }
  double grain_volume() const { return grain_volume_; }  ///< mean of the first frame that has grains [length³]
  const std::vector<double>& density() const { return density_; }  ///< of each frame of the flow [1/length³]

  /// Means over frames, with errors by groups of these.
  Estimate number_density() const;
  Estimate flux() const;  ///< downward, grains per area and time [1/(length² time)]
  /// n_rest - n [1/length³]. What n scatters by between frames, about a trend, is the error of that at rest, where it
  /// comes from a frame.
  Estimate drop() const;
  /// flux/drop: the velocity of what carries the missing volume up [length/time].
  Estimate speed() const;
  double density_at_rest() const;  ///< [1/length³]

 private:
  struct Sums {
    double density = 0, flux = 0;
  };
  Sums sums_of(const Frame& frame);
  double scatter() const;

  SmoothBox box_;
  std::size_t up_;
  double diameter_ = 0, grain_volume_ = 0;
  std::optional<double> phi_at_rest_, at_rest_;
  std::vector<double> density_, flux_;
};

}  // namespace grainvdb
