#include <algorithm>
#include <cmath>

#include "base/vec3.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/line_rule.hpp"

namespace grainvdb {

double LucyKernel::line_integral_midpoint_curvature(const Vec3& p, const Vec3& a) const {
  Vec3 d{}, e{};
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = a[k] * inverse_cutoff_;
    d[k] = p[k] * inverse_cutoff_ + 0.5 * e[k];
  }
  const double q = std::sqrt(dot(d, d));
  if (!(q < 1)) return 0;
  const double rim = 1 - q;
  const double along = dot(d, e);
  // (e·d)²/q goes to 0 with q.
  const double stretched = q > 0 ? along * along / q : 0;
  return norm_ * rim * (rim * (rim * (1 + 3 * q) - 0.5 * dot(e, e)) + stretched);
}

int curved_branch_parts(double length) {
  return std::max(1, static_cast<int>(std::ceil(length / longest_curved_branch)));
}

}  // namespace grainvdb
