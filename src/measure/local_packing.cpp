#include "measure/local_packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grainvdb/moment.hpp"

namespace grainvdb {
namespace {

double largest(const std::vector<double>& radius) {
  return radius.empty() ? 0 : *std::max_element(radius.begin(), radius.end());
}

}  // namespace

// Two caps back to back, of heights r1 - t and r2 - (distance - t); see Weisstein, "Sphere-Sphere Intersection".
double common_volume(double distance, double r1, double r2) {
  if (distance >= r1 + r2) return 0;
  const double least = std::min(r1, r2);
  if (distance <= std::abs(r1 - r2)) return sphere_volume(least);
  const double depth = r1 + r2 - distance;
  const double shape = distance * distance + 2 * distance * (r1 + r2) - 3 * (r1 - r2) * (r1 - r2);
  return std::numbers::pi * depth * depth * shape / (12 * distance);
}

LocalPacking::LocalPacking(const Box& box, const Columns3& position, const std::vector<double>& radius,
                           const VoronoiCells& cells, double reach)
    : cells_(cells), radius_(radius), reach_(reach), grid_(box, position, reach + largest(radius)) {
  volume_.reserve(radius.size());
  for (const double r : radius) volume_.push_back(sphere_volume(r));
}

double LocalPacking::about(std::size_t i) const {
  double grains = 0, cells = 0;
  grid_.around(grid_.position(i), [&](std::size_t j, const Vec3&, double r2) {
    if (r2 > reach_ * reach_ || !is_enclosed(j)) return;
    grains += volume_[j];
    cells += cells_.volume[j];
  });
  return grains / cells;
}

LocalPacking::Window LocalPacking::window(const Vec3& x) const {
  double centres = 0, volume = 0, cells = 0;
  bool enclosed = true;
  grid_.around(x, [&](std::size_t j, const Vec3&, double r2) {
    volume += common_volume(std::sqrt(r2), reach_, radius_[j]);
    if (r2 > reach_ * reach_) return;
    enclosed = enclosed && is_enclosed(j);
    centres += volume_[j];
    cells += cells_.volume[j];
  });
  const double window = sphere_volume(reach_);
  return {enclosed && centres > 0, centres / window, volume / window, centres / cells};
}

std::vector<double> kernel_packing(const Box& box, const Columns3& position, const std::vector<double>& radius,
                                   const LucyKernel& kernel) {
  std::vector<double> phi(radius.size());
  if (radius.empty()) return phi;
  const CellGrid grid(box, position, kernel.cutoff());
  for (std::size_t i = 0; i < phi.size(); ++i)
    grid.around(grid.position(i),
                [&](std::size_t j, const Vec3&, double r2) { phi[i] += sphere_volume(radius[j]) * kernel.value(r2); });
  return phi;
}

}  // namespace grainvdb
