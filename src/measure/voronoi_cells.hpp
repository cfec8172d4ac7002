#pragma once
/// Voronoi cells of grains, by voro++.
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"

namespace grainvdb {

struct VoronoiCells {
  std::vector<double> volume;  ///< [length³]; 0 for a grain whose cell is empty
  std::vector<bool> at_face;   ///< whether the cell ends at a face of the box that is not periodic
};

/// The power (radical) tessellation of the box: grain i has the places x where |x - x_i|² - r_i² is least, which for
/// equal radii are those nearest to it, and for touching spheres the plane between two is their tangent plane. Cells
/// end at the faces of axes that are not periodic.
///
/// What voro++ would end the process for must be ruled out before: centres must be finite and lie in the box along axes
/// that are not periodic, there must be no coincident_pair, and fewer than 2³¹ grains.
VoronoiCells voronoi_cells(const Box& box, const Columns3& position, const std::vector<double>& radius);

/// Two grains whose centres are nearer than 1e-6 mean diameters: no plane can be put between them.
std::optional<std::pair<std::size_t, std::size_t>> coincident_pair(const Box& box, const Columns3& position,
                                                                   const std::vector<double>& radius);

}  // namespace grainvdb
