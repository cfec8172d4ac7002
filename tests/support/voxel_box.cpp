#include "support/voxel_box.hpp"

#include <algorithm>
#include <cmath>

namespace grainvdb::testing {

VoxelBox::VoxelBox(const std::vector<Frame>& frames, double voxel, const Vec3& origin, double reach)
    : voxel_(voxel), origin_(origin), box_(frames.at(0).box) {
  for (std::size_t a = 0; a < 3; ++a) {
    double lo = box_.lo[a];
    double hi = box_.hi[a];
    if (!box_.periodic[a]) {
      for (const Frame& f : frames)
        for (double x : f.particles.position[a]) {
          lo = std::min(lo, x - reach);
          hi = std::max(hi, x + reach);
        }
    }
    first_[a] = static_cast<int>(std::ceil((lo - origin[a]) / voxel - 0.5));
    count_[a] = box_.periodic[a] ? static_cast<std::size_t>(std::lround((hi - lo) / voxel))
                                 : static_cast<std::size_t>(std::ceil((hi - lo) / voxel)) + 1;
  }
}

Coord VoxelBox::coord(std::size_t n) const {
  const auto z = static_cast<int>(n % count_[2]);
  const auto y = static_cast<int>(n / count_[2] % count_[1]);
  const auto x = static_cast<int>(n / count_[2] / count_[1]);
  return {first_[0] + x, first_[1] + y, first_[2] + z};
}

std::optional<std::size_t> VoxelBox::index(Coord c) const {
  std::size_t n = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto count = static_cast<int>(count_[a]);
    int i = c[static_cast<int>(a)] - first_[a];
    if (box_.periodic[a]) i = (i % count + count) % count;
    if (i < 0 || i >= count) return std::nullopt;
    n = n * count_[a] + static_cast<std::size_t>(i);
  }
  return n;
}

Vec3 VoxelBox::centre(const Coord& c) const {
  Vec3 x;
  for (std::size_t a = 0; a < 3; ++a) x[a] = origin_[a] + (c[static_cast<int>(a)] + 0.5) * voxel_;
  return x;
}

Vec3 VoxelBox::to_index_space(const Vec3& x) const {
  Vec3 u;
  for (std::size_t a = 0; a < 3; ++a) u[a] = (x[a] - origin_[a]) / voxel_ - 0.5;
  return u;
}

Coord shifted(Coord c, int axis, int by) {
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) += by;
  return c;
}

}  // namespace grainvdb::testing
