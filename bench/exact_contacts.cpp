#include "exact_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace grainvdb::bench {
namespace {

/// Antiderivative of (1-r)³(1+3r) = 1 - 6 r² + 8 r³ - 3 r⁴ along a line at distance √b2 from the centre, but for its
/// logarithm: y (1 - 6 (b² + y²/3) + 2 r³ + 3 b² r - 3 (b⁴ + y² (2 b²/3 + y²/5))), r² = b² + y².
double polynomial(double b2, double y, double r) {
  const double y2 = y * y;
  return y * (1 - 6 * (b2 + y2 / 3) + 2 * r * r * r + 3 * b2 * r - 3 * (b2 * b2 + y2 * (2 * b2 / 3 + y2 / 5)));
}

}  // namespace

double exact_line_integral(const Vec3& p, const Vec3& a) {
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  const double from = (p[0] * a[0] + p[1] * a[1] + p[2] * a[2]) / length;
  const double b2 = std::max(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - from * from, 0.0);
  if (b2 >= 1) return 0;
  const double rim = std::sqrt(1 - b2);
  double y1 = std::max(from, -rim);
  double y2 = std::min(from + length, rim);
  if (y1 >= y2) return 0;
  if (y1 + y2 < 0) {  // mirrored, so that |y2| ≥ |y1|
    y1 = -y1;
    y2 = -y2;
    std::swap(y1, y2);
  }
  const double r1 = std::sqrt(b2 + y1 * y1);
  const double r2 = std::sqrt(b2 + y2 * y2);
  // 3 b⁴ ln((y2+r2)/(y1+r1)) → 0 as b → 0; y1 + r1 cancels where y1 < 0.
  const double logarithm = b2 < 1e-12 ? 0 : std::log((y2 + r2) / (y1 >= 0 ? y1 + r1 : b2 / (r1 - y1)));
  return (polynomial(b2, y2, r2) - polynomial(b2, y1, r1) + 3 * b2 * b2 * logarithm) / length;
}

Grids exact_contacts(const HalfBranches& branches, double h, std::span<const double> q, int channels) {
  const auto width = static_cast<std::size_t>(channels);
  openvdb::Coord lo, size;
  for (int a = 0; a < 3; ++a) {
    const auto& start = branches.start[static_cast<std::size_t>(a)];
    const auto [least, greatest] = std::minmax_element(start.begin(), start.end());
    lo[a] = static_cast<int>(std::floor((*least - 2 * cutoff) / h));
    size[a] = static_cast<int>(std::ceil((*greatest + 2 * cutoff) / h)) - lo[a] + 1;
  }
  const auto voxel = [&](int i, int j, int k) {
    const auto n = [](int x) { return static_cast<std::size_t>(x); };
    return (n(i - lo[0]) * n(size[1]) + n(j - lo[1])) * n(size[2]) + n(k - lo[2]);
  };
  const std::size_t voxels =
      static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  std::vector<double> sums(voxels * width);
  std::vector<char> reached(voxels);

  for (std::size_t b = 0; b < branches.size(); ++b) {
    const double* values = q.data() + b * width;
    for_each_line_weight(branches, b, h, [&](int i, int j, int k, double w) {
      const std::size_t at = voxel(i, j, k);
      reached[at] = 1;
      double* to = sums.data() + at * width;
      for (std::size_t c = 0; c < width; ++c) to[c] += w * values[c];
    });
  }

  Grids grids;
  for (std::size_t c = 0; c < width; ++c) {
    grids.push_back(openvdb::FloatGrid::create());
    grids.back()->setTransform(plain_transform(h));
    auto accessor = grids.back()->getAccessor();
    for (int i = lo[0]; i < lo[0] + size[0]; ++i)
      for (int j = lo[1]; j < lo[1] + size[1]; ++j)
        for (int k = lo[2]; k < lo[2] + size[2]; ++k)
          if (const std::size_t at = voxel(i, j, k); reached[at] != 0)
            accessor.setValue({i, j, k}, static_cast<float>(sums[at * width + c]));
  }
  return grids;
}

}  // namespace grainvdb::bench
