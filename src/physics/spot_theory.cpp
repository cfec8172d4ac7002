#include "grainvdb/spot_theory.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "grainvdb/line_rule.hpp"

namespace grainvdb {
namespace {

constexpr int nodes = 7;      // of Gauss-Legendre rules, exact to degree 13: r² times degree 11
constexpr int azimuths = 14;  // equal angles: exact for harmonics below 14

/// Calls f(offset, volume) for the points of a product rule over the ball of that radius: Gauss-Legendre along the
/// radius and the cosine of the polar angle, equal weights around the axis.
template <class F>
void for_each_point(double radius, const F& f) {
  for (const LineNode& along : gauss_rule(nodes)) {
    const double r = radius * (1 + along.x) / 2;
    for (const LineNode& polar : gauss_rule(nodes)) {
      const double around = r * std::sqrt(1 - polar.x * polar.x);
      const double volume = radius / 2 * along.weight * r * r * polar.weight * 2 * std::numbers::pi / azimuths;
      for (int k = 0; k < azimuths; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / azimuths;
        f(Vec3{around * std::cos(angle), around * std::sin(angle), r * polar.x}, volume);
      }
    }
  }
}

}  // namespace

MeanField mean_field(const SpotCloud& cloud, const SpotReach& reach, const Vec3& r) {
  double spots = 0;
  Vec3 slope{};
  for_each_point(reach.radius, [&](const Vec3& offset, double volume) {
    const Vec3 at{r[0] + offset[0], r[1] + offset[1], r[2] + offset[2]};
    spots += volume * cloud.density(at);
    const Vec3 gradient = cloud.gradient(at);
    for (std::size_t i = 0; i < 3; ++i) slope[i] += volume * gradient[i];
  });
  MeanField field;
  for (std::size_t i = 0; i < 3; ++i) {
    field.drift[i] = -reach.influence * (spots * cloud.velocity[i] - 2 * reach.place * cloud.diffusivity[i] * slope[i]);
    field.diffusivity[i] = reach.influence * reach.influence * spots * cloud.diffusivity[i];
  }
  return field;
}

}  // namespace grainvdb
