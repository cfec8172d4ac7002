#include "measure/velocity_correlation.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/vec3.hpp"
#include "measure/cell_grid.hpp"
#include "measure/grains.hpp"

namespace grainvdb {
namespace {

/// Grains that one thread takes at a time, at the least; each slab has a few such parts at the most, for each has sums
/// of its own. Sums of parts are added in their order, whoever made them.
constexpr std::size_t least_part = 512;
constexpr std::size_t parts_per_slab = 4;

struct SlabPart {
  std::size_t slab = 0;
  std::vector<std::size_t> grains{};
};

std::vector<SlabPart> parts_of_slabs(const CellGrid& grid, const Slabs& slabs) {
  std::array<std::vector<std::size_t>, Slabs::count> members;
  for (std::size_t i = 0; i < grid.size(); ++i) members[slabs.of(grid.position(i))].push_back(i);
  std::vector<SlabPart> parts;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab) {
    const std::vector<std::size_t>& all = members[slab];
    const std::size_t size = std::max(least_part, (all.size() + parts_per_slab - 1) / parts_per_slab);
    for (std::size_t begin = 0; begin < all.size(); begin += size) {
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
      parts.push_back({slab, {first, first + static_cast<std::ptrdiff_t>(std::min(size, all.size() - begin))}});
    }
  }
  return parts;
}

}  // namespace

VelocityCorrelation::Sums& VelocityCorrelation::Sums::operator+=(const Sums& more) {
  product += more.product;
  first += more.first;
  second += more.second;
  pairs += more.pairs;
  return *this;
}

VelocityCorrelation::VelocityCorrelation(double reach, std::size_t bins) : reach_(reach), bins_(bins) {
  slabs_.fill(std::vector<Sums>(bins));
}

void VelocityCorrelation::add(const Box& box, const Columns3& position, const Columns3& fluctuation,
                              const Slabs& slabs) {
  if (position[0].empty()) return;
  const CellGrid grid(box, position, reach_);
  const double per_length = static_cast<double>(bins_) / reach_;
  std::vector<Vec3> u(grid.size());
  std::vector<double> square(grid.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] = vector_at(fluctuation, i);
    square[i] = dot(u[i], u[i]);
  }
  const std::vector<SlabPart> parts = parts_of_slabs(grid, slabs);
  std::vector<std::vector<Sums>> sums(parts.size(), std::vector<Sums>(bins_));
  parallel_for(parts.size(), [&](std::size_t p) {
    for (const std::size_t i : parts[p].grains)
      grid.neighbours(i, [&](std::size_t j, const Vec3& r, double r2) {
        if (!is_nearest_image(box, r)) return;
        sums[p][std::min(bins_ - 1, static_cast<std::size_t>(std::sqrt(r2) * per_length))] +=
            {dot(u[i], u[j]), square[i], square[j], 1};
      });
  });
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t k = 0; k < bins_; ++k) slabs_[parts[p].slab][k] += sums[p][k];
}

double VelocityCorrelation::middle(std::size_t k) const {
  return reach_ * (static_cast<double>(k) + 0.5) / static_cast<double>(bins_);
}

VelocityCorrelation::Sums VelocityCorrelation::sum(std::size_t k, std::size_t without) const {
  Sums total;
  for (std::size_t slab = 0; slab < Slabs::count; ++slab)
    if (slab != without) total += slabs_[slab][k];
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
