#pragma once
/// The sites of the void model: layers of a lattice, each shifted sideways by half a period against the one below.
#include <array>
#include <cstddef>
#include <optional>

#include "grainvdb/box.hpp"
#include "spot/container.hpp"
#include "spot/particle_store.hpp"

namespace grainvdb::spot {

/// From a site to its upper neighbours it is (±Δx, ±Δy, Δz): sites of a layer lie 2Δx and 2Δy apart. Steps of
/// (½, ½, √½) diameters make the face-centred cubic packing, (1, 1, 1)/√3 the body-centred one. Where Δx or Δy is 0
/// there is no shift along that axis: sites lie as near as diameters allow, above each other.
class StaggeredLattice {
 public:
  /// Sites from the floor up to `height` above it whose spheres lie within the walls: even layers begin and end beside
  /// walls, at equal distances, and odd layers have their sites between those. Throws ConfigError where spheres would
  /// overlap, where a periodic length is no whole number of 2Δ, or where there is no room.
  StaggeredLattice(const Box& box, double diameter, const Vec3& step, double height);

  std::size_t size() const { return (layers_ / 2) * (in_layer(0) + in_layer(1)) + (layers_ % 2) * in_layer(0); }
  std::size_t layers() const { return layers_; }
  std::size_t layer_of(std::size_t site) const { return place(site).layer; }
  /// Within the box [length].
  Vec3 position(std::size_t site) const;
  const Vec3& step() const { return step_; }

  /// Sites of a layer follow each other: the first one, and how many there are in layers 0, 2, … or 1, 3, …
  std::size_t first_of(std::size_t layer) const;
  std::size_t in_layer(std::size_t layer) const { return columns_[layer % 2][0] * columns_[layer % 2][1]; }

  struct Neighbours {
    std::array<std::size_t, 4> site{};
    std::size_t count = 0;
  };
  /// The sites that a void there may hop to: four in the bulk, two where Δx or Δy is 0, fewer at walls, none in the top
  /// layer.
  Neighbours above(std::size_t site) const;

 private:
  struct Place {
    std::size_t layer = 0;
    std::array<std::size_t, 2> column{};
  };
  Place place(std::size_t site) const;
  void set_axis(const Box& box, double diameter, std::size_t axis);

  Vec3 step_{}, first_{};                                ///< position of site 0
  std::array<double, 2> spacing_{};                      ///< of the sites of a layer
  std::array<std::array<std::size_t, 2>, 2> columns_{};  ///< of even and odd layers, along x and y
  std::array<bool, 2> periodic_{};
  std::size_t layers_ = 0;
};

/// A sphere on every site, ids from 1 in the order of the sites.
Packing lattice_packing(const StaggeredLattice& lattice, double diameter);

}  // namespace grainvdb::spot
