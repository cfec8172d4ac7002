#include "measure/wall_cuts.hpp"

#include <cmath>

#include "base/vec3.hpp"

namespace grainvdb {
namespace {

constexpr double roughness = 1e-4;  // of the cube root of a cell's volume

/// How far beyond the half-space a point is, negative inside.
double depth(const HalfSpace& side, const Vec3& x) {
  return side.offset - dot(side.normal, x);
}

/// Takes off what of the cell of a grain at x is beyond the half-space; false where nothing is left.
template <class Cell>
bool keep(Cell& cell, const HalfSpace& side, const Vec3& x, int id) {
  const Vec3& n = side.normal;
  return cell.nplane(-n[0], -n[1], -n[2], -2 * depth(side, x), id);
}

}  // namespace

HalfSpace TangentCut::facing(const Vec3& x) const {
  Vec3 place = corner_;
  for (std::size_t a = 0; a < 3; ++a) place[a] += unit_ * x[a];
  const HalfSpace side = half_space_at(surface_, place);
  return {side.normal, (side.offset - dot(side.normal, corner_)) / unit_};
}

bool TangentCut::point_inside(double x, double y, double z) {
  return depth(facing({x, y, z}), {x, y, z}) <= 0;
}

bool TangentCut::cut_cell(voro::voronoicell& cell, double x, double y, double z) {
  return keep(cell, facing({x, y, z}), {x, y, z}, id_);
}

bool TangentCut::cut_cell(voro::voronoicell_neighbor& cell, double x, double y, double z) {
  return keep(cell, facing({x, y, z}), {x, y, z}, id_);
}

// Worst vertex first: each cut halves the angle between two planes that touch, so that there are few.
bool TangentCut::refine(voro::voronoicell_neighbor& cell, double x, double y, double z) {
  while (is_refinable()) {
    cell.vertices(x, y, z, vertices_);
    HalfSpace worst;
    double deepest = roughness * std::cbrt(cell.volume());
    bool is_rough = false;
    for (std::size_t k = 0; k + 2 < vertices_.size(); k += 3) {
      const Vec3 vertex{vertices_[k], vertices_[k + 1], vertices_[k + 2]};
      const HalfSpace side = facing(vertex);
      if (!(depth(side, vertex) > deepest)) continue;
      deepest = depth(side, vertex);
      worst = side;
      is_rough = true;
    }
    if (!is_rough) break;
    if (!keep(cell, worst, {x, y, z}, id_)) return false;
  }
  return true;
}

}  // namespace grainvdb
