#include "support/static_columns.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/scenes.hpp"

namespace grainvdb::testing {

StaticColumns::StaticColumns(std::uint64_t seed) {
  Random random(seed);
  frame.file = "memory";
  frame.box = {{0, 0, -1}, {6, 6.5, 16}, {true, true, false}};
  std::int64_t id = 0;
  for (int column = 0; column < 3; ++column) {
    const Vec3 x{random.uniform(0, 6), random.uniform(0, 6.5), 0};
    const auto grains = static_cast<std::size_t>(10 + column);
    std::vector<double> load(grains + 1);
    std::vector<Vec3> site;
    std::vector<double> radius;
    std::vector<double> mass;
    double z = 0;
    for (std::size_t k = 0; k < grains; ++k) {
      radius.push_back(random.uniform(0.4, 0.6));
      mass.push_back(random.uniform(1, 3));
      site.push_back({x[0] + random.uniform(-0.3, 0.3), x[1] + random.uniform(-0.3, 0.3), z + radius[k]});
      z += 1.9 * radius[k];
      height.push_back(site[k][2]);
      weight.push_back(mass[k] * gravity);
    }
    for (std::size_t k = grains; k-- > 0;) load[k] = load[k + 1] + mass[k] * gravity;
    add_particle(frame.particles, ++id, 2, {x[0], x[1], -0.5}, {0, 0, 0}, {0, 0, 0}, 0.5, 1);
    for (std::size_t k = 0; k < grains; ++k) {
      add_particle(frame.particles, ++id, 1, site[k], {0, 0, 0}, {0, 0, 0}, radius[k], mass[k]);
      const std::size_t under = frame.particles.size() - 2;
      const double share = random.uniform(0.3, 0.7);
      Vec3 point;
      for (std::size_t a = 0; a < 3; ++a)
        point[a] = site[k][a] + share * (frame.particles.position[a][under] - site[k][a]);
      add_contact(frame.contacts, id, id - 1, {0, 0, load[k]}, point);
      if (k > 0) continue;
      foot_height.push_back(point[2]);
      foot_load.push_back(load[k]);
    }
  }
}

double StaticColumns::total_weight() const {
  return std::accumulate(weight.begin(), weight.end(), 0.0);
}

double marginal_cdf(double zeta) {
  const double q = std::min(std::abs(zeta), 1.0);
  const double half =
      21.0 / 16 * (q - 5 * std::pow(q, 3) / 3 + 3 * std::pow(q, 5) - 8 * std::pow(q, 6) / 3 + 5 * std::pow(q, 7) / 7);
  return 0.5 + (zeta < 0 ? -half : half);
}

}  // namespace grainvdb::testing
