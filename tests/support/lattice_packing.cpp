#include "support/lattice_packing.hpp"

#include "support/scenes.hpp"

namespace grainvdb::testing {

Frame cubic_packing(int n, bool periodic, const std::function<Vec3(const Vec3&)>& velocity) {
  Frame f;
  f.file = "memory";
  f.box = {{-0.5, -0.5, -0.5}, {n - 0.5, n - 0.5, n - 0.5}, {periodic, periodic, periodic}};
  std::int64_t id = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 x{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        add_particle(f.particles, ++id, 1, x, velocity(x), {0, 0, 0}, 0.5, 1);
      }
  return f;
}

Frame one_particle(const Vec3& x) {
  Frame f;
  f.file = "memory";
  for (std::size_t a = 0; a < 3; ++a) {
    f.box.lo[a] = x[a] - 1;
    f.box.hi[a] = x[a] + 1;
  }
  add_particle(f.particles, 1, 1, x, {0, 0, 0}, {0, 0, 0}, 0.5, 1);
  return f;
}

}  // namespace grainvdb::testing
