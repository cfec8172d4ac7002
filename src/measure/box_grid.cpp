#include "measure/box_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace grainvdb {

BoxGrid::BoxGrid(const Vec3& edge, const Box& box, const Vec3& origin) : box_(box), edge_(edge), start_(origin) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(edge[i] > 0) || !std::isfinite(edge[i])) throw std::invalid_argument("boxes need positive edges");
    if (!box.periodic[i]) continue;
    const double period = box.length(static_cast<int>(i));
    edge_[i] = period / std::max(1.0, std::round(period / edge[i]));
    start_[i] = box.lo[i];
  }
}

Vec3 BoxGrid::wrapped(const Vec3& x) const {
  return {box_.wrap(0, x[0]), box_.wrap(1, x[1]), box_.wrap(2, x[2])};
}

BoxIndex BoxGrid::index(const Vec3& x) const {
  const Vec3 inside = wrapped(x);
  BoxIndex index{};
  for (std::size_t i = 0; i < 3; ++i)
    index[i] = static_cast<std::int64_t>(std::floor((inside[i] - start_[i]) / edge_[i]));
  return index;
}

Vec3 BoxGrid::centre(const BoxIndex& index) const {
  Vec3 c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = start_[i] + (static_cast<double>(index[i]) + 0.5) * edge_[i];
  return c;
}

Vec3 BoxGrid::offset(const Vec3& x) const {
  const Vec3 inside = wrapped(x);
  const Vec3 middle = centre(index(x));
  return {inside[0] - middle[0], inside[1] - middle[1], inside[2] - middle[2]};
}

}  // namespace grainvdb
