#include "measure/overlaps.hpp"

#include <algorithm>
#include <cmath>

#include "measure/cell_grid.hpp"

namespace grainvdb {

Overlaps overlaps(const Box& box, const Columns3& position, const std::vector<double>& radius,
                  const CountedRegion& region) {
  Overlaps result;
  double badness = 0, squares = 0, overlapping = 0;
  if (!radius.empty()) {
    const CellGrid grid(box, position, 2 * *std::max_element(radius.begin(), radius.end()));
    for (std::size_t i = 0; i < radius.size(); ++i) {
      if (!region.holds(grid.position(i))) continue;
      ++result.grains;
      bool overlaps_another = false;
      grid.neighbours(i, [&](std::size_t j, const Vec3&, double r2) {
        const double reach = radius[i] + radius[j], depth = reach - std::sqrt(r2);
        if (!(depth > 0)) return;
        overlaps_another = true;
        const double q = depth * depth / (reach * reach);
        badness += q;
        // A pair of counted grains is met twice: one event of weight 2, whose square is 4.
        squares += (region.holds(grid.position(j)) ? 2 : 1) * q * q;
        result.largest = std::max(result.largest, depth / reach);
        result.largest_length = std::max(result.largest_length, depth);
      });
      overlapping += overlaps_another ? 1 : 0;
    }
  }
  const auto n = static_cast<double>(result.grains);
  result.badness = badness / n;
  result.error = std::sqrt(squares) / n;
  result.overlapping = overlapping / n;
  return result;
}

}  // namespace grainvdb
