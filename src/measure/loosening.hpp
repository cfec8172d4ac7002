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
/// volume of the box. There is no face where the box reaches the end of the simulation box or goes beyond it.
struct SmoothBox {
  Vec3 lo{}, hi{};  ///< [length]

  double volume() const { return (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]); }
  /// Cut to the simulation box.
  SmoothBox within(const Box& box) const;
  double weight(const Box& box, const Vec3& x, double diameter) const;
};

/// Number density n and downward flux j of grains in a box, in frames of a flow. The box is cut to that of the first.
class BoxFlow {
 public:
  explicit BoxFlow(const SmoothBox& box, std::size_t up) : box_(box), up_(up) {}

  void add(const Frame& frame, double diameter);
  const std::vector<double>& density() const { return density_; }  ///< of each frame [1/length³]
  const std::vector<double>& flux() const { return flux_; }        ///< of each frame [1/(length² time)]

 private:
  SmoothBox box_;
  std::size_t up_;
  bool is_cut_ = false;
  std::vector<double> density_, flux_;
};

/// What carries missing volume up with a velocity c makes n = n_0 - j/c.
class Loosening {
 public:
  /// Where n_0 comes from.
  enum class Reference {
    rest,   ///< the packing at rest: a frame, or its packing fraction
    layers  ///< the line through n and j of layers of the box, two diameters thick, one above the other
  };
  Loosening(const SmoothBox& box, std::size_t up, Reference reference);

  /// The packing at rest, by a frame or by its packing fraction.
  void rest(const Frame& frame);
  void rest(double phi) { phi_at_rest_ = phi; }
  /// Whether frames of the flow can be added; the first must be at rest otherwise.
  bool has_reference() const { return reference_ == Reference::layers || phi_at_rest_ || at_rest_; }
  /// A frame of the flow that has grains.
  void add(const Frame& frame);

  std::size_t frames() const { return whole_.density().size(); }
  double grain_volume() const { return grain_volume_; }  ///< mean of the first frame that has grains [length³]
  const std::vector<double>& density() const { return whole_.density(); }  ///< of each frame [1/length³]

  /// With errors by groups of frames. That of n_0 is, for a frame, what n scatters by between frames about a trend; for
  /// layers what these leave of a line, where that is more.
  struct Result {
    Estimate at_rest;  ///< n_0 [1/length³]
    Estimate density;  ///< n [1/length³]
    Estimate flux;     ///< j [1/(length² time)]
    Estimate drop;     ///< n_0 - n [1/length³]
    Estimate speed;    ///< c = j/(n_0 - n) [length/time]
  };
  /// NaN without frames.
  Result result() const;

 private:
  void learn_sizes(const Frame& frame);
  Result against_rest() const;
  Result between_layers() const;

  SmoothBox box_;
  std::size_t up_;
  Reference reference_;
  BoxFlow whole_;
  std::vector<BoxFlow> layers_;
  double diameter_ = 0, grain_volume_ = 0;
  std::optional<double> phi_at_rest_, at_rest_;
};

}  // namespace grainvdb
