#include "measure/cell_grid.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace grainvdb {

std::array<std::int64_t, 3> cell_counts(const Vec3& length, double width, std::size_t most) {
  for (;; width *= 1.26) {
    std::array<double, 3> fit{};
    for (std::size_t a = 0; a < 3; ++a) fit[a] = std::max(1.0, std::floor(length[a] / width));
    if (fit[0] * fit[1] * fit[2] > static_cast<double>(most)) continue;
    return {static_cast<std::int64_t>(fit[0]), static_cast<std::int64_t>(fit[1]), static_cast<std::int64_t>(fit[2])};
  }
}

CellGrid::CellGrid(const Box& box, const Columns3& position, double reach) : box_(box), reach_(reach) {
  const std::size_t n = position[0].size();
  if (!(reach > 0) || !std::isfinite(reach)) throw std::invalid_argument("the reach must be positive and finite");
  if (n > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many points");
  Columns3 wrapped = position;
  Vec3 length{};
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    for (double& x : wrapped[a]) {
      if (!std::isfinite(x)) throw std::invalid_argument("a position is not finite");
      x = box.wrap(axis, x);
    }
    const auto [lo, hi] = std::minmax_element(wrapped[a].begin(), wrapped[a].end());
    origin_[a] = box.periodic[a] || n == 0 ? box.lo[a] : *lo;
    length[a] = box.periodic[a] || n == 0 ? box.length(axis) : *hi - *lo;
  }
  count_ = cell_counts(length, reach, n + 64);
  for (std::size_t a = 0; a < 3; ++a) width_[a] = length[a] / static_cast<double>(count_[a]);

  const auto cell_along = [&](std::size_t a, double x) {
    if (!(width_[a] > 0)) return std::int64_t{0};
    return std::clamp(static_cast<std::int64_t>((x - origin_[a]) / width_[a]), std::int64_t{0}, count_[a] - 1);
  };
  std::vector<std::uint32_t> cell(n);
  start_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]) + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    cell[i] = static_cast<std::uint32_t>((cell_along(0, wrapped[0][i]) * count_[1] + cell_along(1, wrapped[1][i])) *
                                             count_[2] +
                                         cell_along(2, wrapped[2][i]));
    ++start_[cell[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  point_.resize(n);
  slot_.resize(n);
  at_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t slot = next[cell[i]]++;
    point_[slot] = static_cast<std::uint32_t>(i);
    slot_[i] = slot;
    at_[slot] = {wrapped[0][i], wrapped[1][i], wrapped[2][i]};
  }
}

// A hair more than the reach, so that rounding of the cells' bounds hides no point at the edge of it.
CellGrid::Cells CellGrid::range(std::size_t axis, double x) const {
  if (!(width_[axis] > 0)) return {0, 0};
  const double reach = reach_ * (1 + 1e-9), at = x - origin_[axis];
  const double first = std::floor((at - reach) / width_[axis]), last = std::floor((at + reach) / width_[axis]);
  if (box_.periodic[axis]) return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last)};
  const auto end = static_cast<double>(count_[axis] - 1);
  // A range that lies outside is empty; clamping its ends apart keeps it so.
  return {static_cast<std::int64_t>(std::clamp(first, 0.0, end + 1)),
          static_cast<std::int64_t>(std::clamp(last, -1.0, end))};
}

}  // namespace grainvdb
