#include "measure/plane_means.hpp"

#include <cmath>

#include "grainvdb/moment.hpp"
#include "splat/profile.hpp"

namespace grainvdb {
namespace {

/// The mean velocity between planes.
class PlaneVelocity {
 public:
  PlaneVelocity(const PlaneSums& sums, const Lattice& lattice, int axis)
      : sums_(sums), lattice_(lattice), axis_(axis) {}

  Vec3 at(double position) const {
    const double index = lattice_.wrap_index(axis_, lattice_.to_index(axis_, position));
    const double below = std::floor(index);
    const double share = index - below;
    const std::int64_t low = plane(static_cast<std::int64_t>(below)),
                       high = plane(static_cast<std::int64_t>(below) + 1);
    const double volume = (1 - share) * value(low, 0) + share * value(high, 0);
    Vec3 u;
    for (int a = 0; a < 3; ++a)
      u[static_cast<std::size_t>(a)] = ((1 - share) * value(low, 2 + a) + share * value(high, 2 + a)) / volume;
    return u;
  }

 private:
  /// The row of a plane, which is one of the stored period.
  std::int64_t plane(std::int64_t index) const {
    return std::int64_t{lattice_.wrap(axis_, static_cast<std::int32_t>(index))} - sums_.first;
  }
  double value(std::int64_t row, int channel) const {
    if (row < 0 || row >= static_cast<std::int64_t>(sums_.planes())) return 0;
    return sums_.value(static_cast<std::size_t>(row), channel);
  }

  const PlaneSums& sums_;
  const Lattice& lattice_;
  int axis_;
};

}  // namespace

PlaneMeans plane_means(const Particles& particles, const Lattice& lattice, const LucyKernel& kernel, int axis,
                       double area) {
  constexpr int direct = PlaneMeans::heat;  // channels that need no mean
  const std::vector<double>& position = particles.position[static_cast<std::size_t>(axis)];
  std::vector<double> q;
  q.reserve(particles.size() * direct);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double volume = sphere_volume(particles.radius[p]);
    q.insert(q.end(), {volume, particles.mass[p], volume * particles.velocity[0][p], volume * particles.velocity[1][p],
                       volume * particles.velocity[2][p], volume * 2 * particles.radius[p]});
  }
  const PlaneSums sums = splat_planes(lattice, kernel, axis, position, q, direct);
  PlaneMeans means;
  if (particles.size() == 0) return means;

  const PlaneVelocity velocity(sums, lattice, axis);
  std::vector<double> heat(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 u = velocity.at(position[p]);
    for (std::size_t a = 0; a < 3; ++a) heat[p] += std::pow(particles.velocity[a][p] - u[a], 2);
    heat[p] *= sphere_volume(particles.radius[p]);
  }
  const PlaneSums heats = splat_planes(lattice, kernel, axis, position, heat, 1);

  means.first = sums.first;
  for (std::size_t n = 0; n < sums.planes(); ++n) {
    for (int c = 0; c < direct; ++c) means.values.push_back(sums.value(n, c) / area);
    means.values.push_back(heats.value(n, 0) / area);
  }
  return means;
}

}  // namespace grainvdb
