#pragma once
/// Walls that cut the cells of voro++.
#include <vector>

#include <voro++/voro++.hh>

#include "grainvdb/walls.hpp"

namespace grainvdb {

/// What voro++ calls a wall: it cuts each cell by the plane that touches the surface where it is nearest to the grain.
/// That is the end of it at a plane. Within a cylinder or a cone it leaves too much, which refine takes off; around one
/// it takes too much.
class TangentCut : public voro::wall {
 public:
  /// `id` is what the cell calls its face, < 0. voro++ measures from `corner` in lengths of `unit`.
  TangentCut(const Wall& surface, int id, const Vec3& corner, double unit)
      : surface_(surface), id_(id), corner_(corner), unit_(unit) {}

  bool point_inside(double x, double y, double z) override;
  bool cut_cell(voro::voronoicell& cell, double x, double y, double z) override;
  bool cut_cell(voro::voronoicell_neighbor& cell, double x, double y, double z) override;

  /// Cuts the cell of a grain at (x, y, z) by further planes that touch a cylinder or cone from outside, until no
  /// vertex is farther beyond it than 1e-4 of the cube root of the cell's volume. False where nothing is left.
  bool refine(voro::voronoicell_neighbor& cell, double x, double y, double z);

 private:
  /// In units of voro++.
  HalfSpace facing(const Vec3& x) const;
  bool is_refinable() const { return surface_.shape != Wall::Shape::plane && surface_.encloses; }

  Wall surface_;
  int id_;
  Vec3 corner_;
  double unit_;
  std::vector<double> vertices_;
};

}  // namespace grainvdb
