#include "measure/voronoi_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <voro++/voro++.hh>

#include "measure/cell_grid.hpp"
#include "measure/grains.hpp"
#include "measure/wall_cuts.hpp"

namespace grainvdb {
namespace {

constexpr double grains_per_block = 5;  // voro++ is fastest at five to eight
constexpr double coincident = 1e-6;     // in mean diameters
constexpr int first_wall = -7;          // voro++ calls the faces of the box -1 to -6

Box room_of_cells(Box box, const std::vector<double>& radius, const WallDomain& walls) {
  if (walls.walls().empty()) return box;
  const double margin = 2 * *std::max_element(radius.begin(), radius.end());
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.periodic[a]) continue;
    box.lo[a] -= margin;
    box.hi[a] += margin;
  }
  return box;
}

std::vector<TangentCut> cuts_by(const WallDomain& walls, const Vec3& corner, double unit) {
  std::vector<TangentCut> cuts;
  for (const Wall& wall : walls.walls())
    cuts.emplace_back(wall, first_wall - static_cast<int>(cuts.size()), corner, unit);
  return cuts;
}

}  // namespace

// voro++ compares lengths with an absolute 1e-11: mean diameters from the lower corner are its unit of length.
VoronoiCells voronoi_cells(const Box& box, const Columns3& position, const std::vector<double>& radius,
                           const WallDomain& walls) {
  const std::size_t n = radius.size();
  VoronoiCells cells{std::vector<double>(n), std::vector<bool>(n), std::vector<bool>(n)};
  if (n == 0) return cells;
  const double unit = mean_diameter(radius);
  const Box room = room_of_cells(box, radius, walls);
  Vec3 length{};
  double volume = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    length[a] = room.length(static_cast<int>(a)) / unit;
    volume *= length[a];
  }
  const double block = std::cbrt(volume * grains_per_block / static_cast<double>(n));
  const auto blocks = cell_counts(length, block, n / 2 + 8);
  voro::container_poly container(0, length[0], 0, length[1], 0, length[2], static_cast<int>(blocks[0]),
                                 static_cast<int>(blocks[1]), static_cast<int>(blocks[2]), box.periodic[0],
                                 box.periodic[1], box.periodic[2], 8);
  std::vector<TangentCut> cuts = cuts_by(walls, room.lo, unit);
  for (TangentCut& cut : cuts) container.add_wall(cut);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      // A centre at the upper face would belong to the block behind it, which does not exist.
      x[a] = std::min((box.wrap(axis, position[a][i]) - room.lo[a]) / unit, std::nextafter(length[a], 0.0));
    }
    container.put(static_cast<int>(i), x[0], x[1], x[2], radius[i] / unit);
  }
  voro::c_loop_all loop(container);
  voro::voronoicell_neighbor cell;
  std::vector<int> faces;
  if (!loop.start()) return cells;
  do {
    if (!container.compute_cell(cell, loop)) continue;
    double x = 0, y = 0, z = 0;
    loop.pos(x, y, z);
    if (!std::all_of(cuts.begin(), cuts.end(), [&](TangentCut& cut) { return cut.refine(cell, x, y, z); })) continue;
    const auto i = static_cast<std::size_t>(loop.pid());
    cells.volume[i] = cell.volume() * unit * unit * unit;
    cell.neighbors(faces);
    cells.at_face[i] = std::any_of(faces.begin(), faces.end(), [](int id) { return id < 0 && id > first_wall; });
    cells.at_wall[i] = std::any_of(faces.begin(), faces.end(), [](int id) { return id <= first_wall; });
  } while (loop.inc());
  return cells;
}

std::optional<std::pair<std::size_t, std::size_t>> coincident_pair(const Box& box, const Columns3& position,
                                                                   const std::vector<double>& radius) {
  std::optional<std::pair<std::size_t, std::size_t>> found;
  if (radius.empty()) return found;
  const CellGrid grid(box, position, coincident * mean_diameter(radius));
  for (std::size_t i = 0; i < grid.size() && !found; ++i)
    grid.neighbours(i, [&](std::size_t j, const Vec3&, double) { found = {std::min(i, j), std::max(i, j)}; });
  return found;
}

}  // namespace grainvdb
