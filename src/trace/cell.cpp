#include "trace/cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace grainvdb {

Cell cell_at(const Lattice& lattice, const Vec3& x) {
  std::array<double, 3> whole{};
  Cell cell;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    double u = lattice.to_index(a, x[i]);
    double last = std::numeric_limits<double>::max();
    if (const auto& period = lattice.period(a)) {
      u -= period->length * std::floor((u - period->first) / period->length);
      last = period->first + period->count - 1;
    }
    whole[i] = std::min(std::floor(u), last);
    cell.within[i] = u - whole[i];
  }
  cell.voxel = {static_cast<std::int32_t>(whole[0]), static_cast<std::int32_t>(whole[1]),
                static_cast<std::int32_t>(whole[2])};
  return cell;
}

}  // namespace grainvdb
