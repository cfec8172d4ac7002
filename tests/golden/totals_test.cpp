// Fields of a real run hold what its grains hold.
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::totals_test {
namespace {

// Each grain's own part is off by up to 2.4e-5 at c/h = 6, one way or the other as it lies between the voxels: of some
// 560 grains in five frames 8e-7 is left.
TEST(Totals, OfTheShearCell) {
  Pipeline p = shear_cell_pipeline({"phi", "density", "velocity"});
  set_option(p, "velocity", "weighting", std::string("mass"));
  p.select.types = {1};
  const auto source = open_dumps(p.input);
  ASSERT_NEAR(p.cutoff / p.voxel, 6, 1e-9);
  const Result r = run(p, *source);
  const Written& w = r.only();
  double volume = 0, mass = 0;
  Vec3 momentum{};
  w.field("phi").for_each_active([&](const Coord& c) {
    const double cell = std::pow(p.voxel, 3), density = w.field("density").at(c);
    volume += cell * static_cast<double>(w.field("phi").at(c));
    mass += cell * density;
    if (!(density > 0)) return;
    for (std::size_t a = 0; a < 3; ++a)
      momentum[a] += cell * density * static_cast<double>(w.field("velocity").at(c, static_cast<int>(a)));
  });

  double grain_volume = 0, grain_mass = 0;
  Vec3 grain_momentum{};
  const auto frames = static_cast<double>(source->frames().size());
  for (std::size_t k = 0; k < source->frames().size(); ++k) {
    const Particles all = source->read(k, Column::velocity | Column::radius | Column::mass | Column::type).particles;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.type[i] != 1) continue;
      grain_volume += sphere_volume(all.radius[i]) / frames;
      grain_mass += all.mass[i] / frames;
      for (std::size_t a = 0; a < 3; ++a) grain_momentum[a] += all.mass[i] * all.velocity[a][i] / frames;
    }
  }
  EXPECT_NEAR(volume / grain_volume, 1, 1e-6);
  EXPECT_NEAR(mass / grain_mass, 1, 1e-6);
  const double largest = std::hypot(grain_momentum[0], grain_momentum[1], grain_momentum[2]);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(momentum[a] / largest, grain_momentum[a] / largest, 1e-6) << a;
}

}  // namespace
}  // namespace grainvdb::testing::totals_test
