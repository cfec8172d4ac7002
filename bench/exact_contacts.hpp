#pragma once
/// Baseline: the contact stress as exactly and as simply as it can be had. Each half branch visits the voxels that it
/// can reach and adds its values times the closed form of the line integral, all in double precision, to sums [voxel]
/// [channel] of a dense box; these are stored in FloatGrids at the end. It is frozen: the library's own evaluation of
/// the line integral is not used, so that it can change.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "grainvdb/moment.hpp"
#include "grids.hpp"
#include "lucy.hpp"
#include "scene.hpp"

namespace grainvdb::bench {

/// ∫₀¹ W(|p + s a|) ds / W(0) by the antiderivative, with lengths in units of the cutoff: correct to 1e-14,
/// and by so much may it be negative.
double exact_line_integral(const Vec3& p, const Vec3& a);

/// Calls f(i, j, k, ∫W) for the voxels that half branch b reaches.
template <class F>
void for_each_line_weight(const HalfBranches& branches, std::size_t b, double h, F&& f) {
  const double peak = lucy_peak(cutoff);
  Vec3 start{}, arm{};
  std::array<int, 3> first{}, last{};
  double length2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    start[a] = branches.start[a][b];
    arm[a] = branches.arm[a][b] / cutoff;
    length2 += arm[a] * arm[a];
    const double end = start[a] - branches.arm[a][b];
    first[a] = static_cast<int>(std::ceil((std::min(start[a], end) - cutoff) / h - 0.5));
    last[a] = static_cast<int>(std::floor((std::max(start[a], end) + cutoff) / h - 0.5));
  }
  const auto distance = [&](std::size_t a, int i) { return ((i + 0.5) * h - start[a]) / cutoff; };
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int k = first[2]; k <= last[2]; ++k) {
        const Vec3 p{distance(0, i), distance(1, j), distance(2, k)};
        // The nearest point p + s a of the branch must lie inside the support.
        const double pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
        const double pa = p[0] * arm[0] + p[1] * arm[1] + p[2] * arm[2];
        const double s = std::min(std::max(-pa / length2, 0.0), 1.0);
        if (pp + s * (2 * pa + s * length2) >= 1) continue;
        f(i, j, k, peak * std::max(exact_line_integral(p, arm), 0.0));
      }
}

/// `q` is laid out [branch][channel].
Grids exact_contacts(const HalfBranches& branches, double h, std::span<const double> q, int channels);

}  // namespace grainvdb::bench
