#pragma once
/// Where a spot run takes place: a box with periodic sides or walls, and a flat floor with an orifice or none.
#include <array>
#include <optional>

#include "grainvdb/box.hpp"

namespace grainvdb::spot {

/// A hole in the floor, which is a thin plate at the lower end of the box along z.
struct Orifice {
  enum class Shape {
    slot,   ///< |x - centre| < width/2, through the whole depth
    circle  ///< of that diameter
  };
  Shape shape = Shape::slot;
  std::array<double, 2> centre{};  ///< x, y [length]
  double width = 0;                ///< [length]
};

/// The walls are the ends of the box along axes that are not periodic. There is no wall at the top.
struct Container {
  Box box;
  std::optional<Orifice> orifice;  ///< only where z is not periodic
};

/// From the nearest point of the orifice's rim to a point over the hole, in the plane of the floor; nothing for a point
/// over the plate [length].
std::optional<std::array<double, 2>> from_rim(const Container& container, const Vec3& x);

/// How far from the middle of the orifice points at that height above the floor can be that are at least `distance`
/// from the plate beside it: along x for a slot; infinite without an orifice, and where all are, 0 where none is
/// [length].
double room_over_orifice(const Container& container, double height, double distance);

/// A step from x, cut towards the middle of the orifice so that its end is no nearer than `distance` to the plate
/// beside it. Where x is nearer already, over the plate, the step is what it was.
Vec3 kept_off_plate(const Container& container, const Vec3& x, Vec3 step, double distance);

/// Σ δ n over the walls, the floor and the rim of the orifice that a sphere of this diameter overlaps: what moves it
/// out of each [length].
Vec3 push_from_walls(const Container& container, const Vec3& x, double diameter);

}  // namespace grainvdb::spot
