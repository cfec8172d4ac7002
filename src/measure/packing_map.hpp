#pragma once
/// Where the packing is dense and where loose: a map of the packing fraction by Voronoi cells and by the kernel.
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "grainvdb/box.hpp"
#include "grainvdb/table.hpp"

namespace grainvdb {

/// Grains by the square of a plane that their centres are in; along the axis across it they are taken together. Squares
/// lie at whole multiples of their edge, so that those of several runs are the same.
class PackingMap {
 public:
  /// `across` is an axis, `edge` that of a square, > 0 [length].
  PackingMap(std::size_t across, double edge);

  /// A grain at x: its volume and that of its cell [length³], and the field φ at its centre.
  void add(const Vec3& x, double volume, double cell, double kernel_phi);

  /// Table voronoi_map: ΣV/ΣV_cell and the mean of φ, weighted by V, of each square that has grains; its middle, rows
  /// along the first of the two axes first.
  Table table() const;

 private:
  struct Square {
    double volume = 0, cells = 0, smoothed = 0;
    std::size_t grains = 0;
  };

  std::size_t first_, second_;  // the axes of the plane
  double edge_;
  std::map<std::pair<std::int64_t, std::int64_t>, Square> squares_;  // by place along the second axis, then the first
};

}  // namespace grainvdb
