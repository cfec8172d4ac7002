#pragma once
/// Voronoi cells of grains, by voro++.
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

struct VoronoiCells {
  std::vector<double> volume;  ///< [length³]; 0 for a grain whose cell is empty
  std::vector<bool> at_face;   ///< whether the cell ends at a face of the box that is not periodic
  std::vector<bool> at_wall;   ///< whether it ends at a wall
};

/// The power (radical) tessellation of the box: grain i has the places x where |x - x_i|² - r_i² is least, which for
/// equal radii are those nearest to it, and for touching spheres the plane between two is their tangent plane. Cells
/// end at walls: exactly at planes, within 1e-4 of their size within cylinders and cones, and around these at one plane
/// that touches the wall. They end at the faces of axes that are not periodic, too, a largest diameter outside where
/// there are walls, as many a box ends at the outermost centres, short of the walls.
///
/// Centres behind a wall have cells that mean nothing: leave them out.
/// What voro++ would end the process for must be ruled out before: centres must be finite and lie in the box along axes
/// that are not periodic, there must be no coincident_pair, and fewer than 2³¹ grains.
VoronoiCells voronoi_cells(const Box& box, const Columns3& position, const std::vector<double>& radius,
                           const WallDomain& walls = {});

/// Two grains whose centres are nearer than 1e-6 mean diameters: no plane can be put between them.
std::optional<std::pair<std::size_t, std::size_t>> coincident_pair(const Box& box, const Columns3& position,
                                                                   const std::vector<double>& radius);

}  // namespace grainvdb
