#include "measure/velocity_correlation.hpp"

#include <algorithm>
#include <cmath>

#include "measure/cell_grid.hpp"
#include "measure/grains.hpp"

namespace grainvdb {

VelocityCorrelation::VelocityCorrelation(double reach, std::size_t bins) : reach_(reach), bins_(bins) {
  slabs_.fill(std::vector<Sums>(bins));
}

void VelocityCorrelation::add(const Box& box, const Columns3& position, const Columns3& fluctuation,
                              const Slabs& slabs) {
  if (position[0].empty()) return;
  const CellGrid grid(box, position, reach_);
  const double per_length = static_cast<double>(bins_) / reach_;
  const auto dot = [](const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  std::vector<Vec3> u(grid.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = vector_at(fluctuation, i);
  for (std::size_t i = 0; i < u.size(); ++i) {
    std::vector<Sums>& sums = slabs_[slabs.of(grid.position(i))];
    const double own = dot(u[i], u[i]);
    grid.neighbours(i, [&](std::size_t j, const Vec3& r, double r2) {
      if (!is_nearest_image(box, r)) return;
      Sums& s = sums[std::min(bins_ - 1, static_cast<std::size_t>(std::sqrt(r2) * per_length))];
      s.product += dot(u[i], u[j]);
      s.first += own;
      s.second += dot(u[j], u[j]);
      ++s.pairs;
    });
  }
}

double VelocityCorrelation::middle(std::size_t k) const {
  return reach_ * (static_cast<double>(k) + 0.5) / static_cast<double>(bins_);
}

VelocityCorrelation::Sums VelocityCorrelation::sum(std::size_t k, std::size_t without) const {
  Sums total;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab) {
    if (slab == without) continue;
    const Sums& s = slabs_[slab][k];
    total.product += s.product;
    total.first += s.first;
    total.second += s.second;
    total.pairs += s.pairs;
  }
  return total;
}

std::size_t VelocityCorrelation::pairs(std::size_t k) const {
  return sum(k).pairs;
}

double VelocityCorrelation::c(std::size_t k) const {
  const Sums s = sum(k);
  return s.product / std::sqrt(s.first * s.second);
}

double VelocityCorrelation::error(std::size_t k) const {
  std::vector<double> left_out;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab) {
    if (slabs_[slab][k].pairs == 0) continue;
    const Sums s = sum(k, slab);
    left_out.push_back(s.product / std::sqrt(s.first * s.second));
  }
  return jackknife_error(left_out);
}

std::vector<double> VelocityCorrelation::without(std::size_t slab) const {
  std::vector<double> result;
  if (std::all_of(slabs_[slab].begin(), slabs_[slab].end(), [](const Sums& s) { return s.pairs == 0; })) return result;
  for (std::size_t k = 0; k < bins_; ++k) {
    const Sums s = sum(k, slab);
    result.push_back(s.product / std::sqrt(s.first * s.second));
  }
  return result;
}

}  // namespace grainvdb
