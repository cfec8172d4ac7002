#include "bin/buckets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "grainvdb/topology.hpp"

namespace grainvdb {
namespace {

// The images of one coordinate: u + k n for k = first … last.
struct Images {
  double u = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
};

// The wrapped coordinate, and those of its images from which a voxel of the stored period is within `reach` (in
// voxels).
Images images(const Lattice& lattice, int axis, double x, double reach) {
  const double u = lattice.wrap_index(axis, lattice.to_index(axis, x));
  constexpr double largest = std::numeric_limits<std::int32_t>::max() - 4 * leaf_edge;
  if (!(std::abs(u) + 2 * reach < largest))
    throw std::invalid_argument("position " + std::to_string(x) + " does not fit the voxel index range");
  const auto& period = lattice.period(axis);
  if (!period) return {u, 0, 0};
  const double n = period->count;
  return {u, static_cast<std::int64_t>(std::ceil((period->first - reach - u) / n)),
          static_cast<std::int64_t>(std::floor((period->first + n - 1 + reach - u) / n))};
}

// Origin of the leaf cell of the voxel that holds index position u.
std::int32_t cell(double u) {
  return static_cast<std::int32_t>(std::floor(u + 0.5)) & ~(leaf_edge - 1);
}

using Cells = std::array<std::vector<std::int32_t>, 3>;

// Stable sort of `order` by the cell coordinate along one axis, by digits of 16 bits.
void radix_sort(const std::vector<std::int32_t>& key, std::vector<std::size_t>& order) {
  const auto [low, high] = std::minmax_element(key.begin(), key.end());
  const std::int32_t base = *low;
  const auto digits = [base](std::int32_t k) {
    return static_cast<std::uint32_t>(std::int64_t{k} - base) / static_cast<std::uint32_t>(leaf_edge);
  };
  std::vector<std::size_t> sorted(order.size());
  for (unsigned shift = 0; shift < 32 && (digits(*high) >> shift) != 0; shift += 16) {
    std::vector<std::size_t> begin((std::min<std::uint32_t>(digits(*high) >> shift, 0xffff)) + 2);
    for (const std::int32_t k : key) ++begin[((digits(k) >> shift) & 0xffff) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const std::size_t e : order) sorted[begin[(digits(key[e]) >> shift) & 0xffff]++] = e;
    order.swap(sorted);
  }
}

}  // namespace

Buckets bin_points(const Lattice& lattice, const Columns3& position, double reach) {
  if (!(reach >= 0) || !std::isfinite(reach)) throw std::invalid_argument("the reach must be finite and not negative");
  const std::size_t points = position[0].size();
  if (points > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many points");
  const double r = reach / lattice.voxel();

  // Entries in ascending order of their points; stable sorting keeps that order within each cell.
  Buckets unsorted;
  Cells key;
  for (std::size_t p = 0; p < points; ++p) {
    const std::array<Images, 3> image{images(lattice, 0, position[0][p], r), images(lattice, 1, position[1][p], r),
                                      images(lattice, 2, position[2][p], r)};
    std::array<std::int64_t, 3> k{};
    const auto coordinate = [&](int axis) {
      const auto& period = lattice.period(axis);
      return period ? image[axis].u + static_cast<double>(k[axis]) * period->count : image[axis].u;
    };
    for (k[0] = image[0].first; k[0] <= image[0].last; ++k[0])
      for (k[1] = image[1].first; k[1] <= image[1].last; ++k[1])
        for (k[2] = image[2].first; k[2] <= image[2].last; ++k[2]) {
          unsorted.point.push_back(static_cast<std::uint32_t>(p));
          for (int a = 0; a < 3; ++a) {
            unsorted.index[a].push_back(coordinate(a));
            key[a].push_back(cell(unsorted.index[a].back()));
          }
        }
  }

  const std::size_t entries = unsorted.point.size();
  if (entries > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many periodic images");
  Buckets b;
  b.start.push_back(0);
  if (entries == 0) return b;
  std::vector<std::size_t> order(entries);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (int a = 2; a >= 0; --a) radix_sort(key[a], order);

  b.point.reserve(entries);
  for (auto& column : b.index) column.reserve(entries);
  for (auto& column : b.local) column.reserve(entries + Buckets::padding);
  for (const std::size_t e : order) {
    const Coord c{key[0][e], key[1][e], key[2][e]};
    if (b.cells.empty() || b.cells.back() != c) {
      if (!b.cells.empty()) b.start.push_back(b.point.size());
      b.cells.push_back(c);
    }
    b.point.push_back(unsorted.point[e]);
    for (int a = 0; a < 3; ++a) {
      b.index[a].push_back(unsorted.index[a][e]);
      b.local[a].push_back(static_cast<float>(b.index[a].back() - (c[a] + 3.5)));
    }
  }
  for (auto& column : b.local) column.resize(entries + Buckets::padding);
  b.start.push_back(entries);
  return b;
}

}  // namespace grainvdb
