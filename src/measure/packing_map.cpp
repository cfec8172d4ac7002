#include "measure/packing_map.hpp"

#include <cmath>
#include <string>

namespace grainvdb {

PackingMap::PackingMap(std::size_t across, double edge)
    : first_(across == 0 ? 1 : 0), second_(across == 2 ? 1 : 2), edge_(edge) {}

void PackingMap::add(const Vec3& x, double volume, double cell, double kernel_phi) {
  const auto place = [&](std::size_t axis) { return static_cast<std::int64_t>(std::floor(x[axis] / edge_)); };
  Square& square = squares_[{place(second_), place(first_)}];
  square.volume += volume;
  square.cells += cell;
  square.smoothed += volume * kernel_phi;
  ++square.grains;
}

Table PackingMap::table() const {
  Table table{"voronoi_map", "map of the packing fraction by Voronoi cells and by the kernel",
              "cells: sum V/sum V_cell; kernel: sum V phi(x)/sum V, over the grains of a square in all frames"};
  const auto name = [](std::size_t axis) { return std::string(1, "xyz"[axis]); };
  table.columns = {{name(first_), dimension::length, "middle of the square"},
                   {name(second_), dimension::length, "middle of the square"},
                   {"cells", dimension::none, "packing fraction of the cells of its grains"},
                   {"kernel", dimension::none, "mean of the field phi at the centres of its grains"},
                   {"grains", dimension::none, "grains in all frames"}};
  const auto middle = [&](std::int64_t place) { return (static_cast<double>(place) + 0.5) * edge_; };
  for (const auto& [place, square] : squares_) {
    const double row[] = {middle(place.second), middle(place.first), square.volume / square.cells,
                          square.smoothed / square.volume, static_cast<double>(square.grains)};
    for (std::size_t c = 0; c < table.columns.size(); ++c) table.columns[c].values.push_back(row[c]);
  }
  if (squares_.empty()) table.remarks.emplace_back("No grain that counts has a cell that ends at other grains alone.");
  return table;
}

}  // namespace grainvdb
