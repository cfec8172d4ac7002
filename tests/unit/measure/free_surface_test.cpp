// The angle of inclined planes of grains.
#include "measure/free_surface.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::free_surface_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

TEST(FreeSurface, HasTheAngleOfAPlaneExactly) {
  Random random(1);
  for (const double angle : {0.0, 12.0, 35.0}) {
    const double sx = std::tan(angle * degree) * 0.6, sy = std::tan(angle * degree) * 0.8;
    Scene s;
    s.box = {{0, 0, 0}, {20, 10, 40}, {false, false, false}};
    for (int n = 0; n < 300; ++n) {
      const double x = random.uniform(0, 20), y = random.uniform(0, 10), r = random.uniform(0.3, 0.6);
      s.add({x, y, 5 + sx * x + sy * y - r}, r);
      s.add({x, y, random.uniform(0, 4)}, r);
    }
    FreeSurface surface(2, 2);
    surface.add(s.box, s.position, s.radius);
    const SurfacePlane p = surface.plane();
    EXPECT_NEAR(p.angle, angle * degree, 1e-12);
    EXPECT_NEAR(p.slope[0], sx, 1e-12);
    EXPECT_NEAR(p.slope[1], sy, 1e-12);
    EXPECT_LT(p.angle_error, 1e-12);
    EXPECT_EQ(p.columns, 50U);
  }
}

TEST(FreeSurface, StatesItsError) {
  // Grains at random places below the plane, of which the highest of each column count.
  constexpr int runs = 40;
  double chi2 = 0, mean = 0, error = 0;
  for (int run = 0; run < runs; ++run) {
    Random random(90 + static_cast<std::uint64_t>(run));
    Scene s;
    s.box = {{0, 0, 0}, {30, 8, 40}, {false, true, false}};
    for (int n = 0; n < 8000; ++n) {
      const double x = random.uniform(0, 30), y = random.uniform(0, 8), z = random.uniform(0, 30);
      if (z < 5 + std::tan(24 * degree) * x) s.add({x, y, z}, 0.5);
    }
    FreeSurface surface(2, 2);
    surface.add(s.box, s.position, s.radius);
    const SurfacePlane p = surface.plane();
    EXPECT_EQ(p.slope[1], 0);
    chi2 += std::pow((p.angle - 24 * degree) / p.angle_error, 2) / runs;
    mean += p.angle / runs;
    error += p.angle_error / runs;
  }
  EXPECT_LT(error, 1 * degree);
  EXPECT_NEAR(mean, 24 * degree, 4 * error / std::sqrt(runs));
  // Mean of 40 squares of unit normals: 1 ± 0.22.
  EXPECT_NEAR(chi2, 1, 4 * std::sqrt(2.0 / runs));
}

TEST(FreeSurface, KnowsTheVerticalAxis) {
  Scene s;
  s.box = {{0, 0, 0}, {40, 10, 10}, {false, false, false}};
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) s.add({7 + 0.4 * (j + 0.5), i + 0.5, j + 0.5}, 0.5);
  FreeSurface surface(0, 1);
  surface.add(s.box, s.position, s.radius);
  EXPECT_NEAR(surface.plane().slope[0], 0, 1e-13);    // along y
  EXPECT_NEAR(surface.plane().slope[1], 0.4, 1e-13);  // along z
}

TEST(FreeSurface, IsUndefinedWhereThereIsNothingToFit) {
  FreeSurface none(2, 1);
  EXPECT_TRUE(std::isnan(none.plane().angle));
  Scene s = poisson({{0, 0, 0}, {9, 9, 9}, {true, true, false}}, 200, 2);
  FreeSurface periodic(2, 1);
  periodic.add(s.box, s.position, s.radius);
  EXPECT_TRUE(std::isnan(periodic.plane().angle));
  // All in one row: no slope across it.
  Scene row;
  row.box = {{0, 0, 0}, {9, 9, 9}, {false, false, false}};
  for (int i = 0; i < 9; ++i) row.add({i + 0.5, 4.5, 3}, 0.5);
  FreeSurface along(2, 1);
  along.add(row.box, row.position, row.radius);
  EXPECT_TRUE(std::isnan(along.plane().angle));
}

TEST(Supported, AreNotThoseInFlight) {
  Scene s = simple_cubic(4);
  s.box.periodic[2] = false;
  s.box.hi[2] += 10;
  s.add({1, 1, 8}, 0.5);
  const std::vector<bool> counts = supported(s.box, s.position, 1.5, 3);
  EXPECT_FALSE(counts.back());
  EXPECT_TRUE(std::all_of(counts.begin(), counts.end() - 1, [](bool b) { return b; }));
}

}  // namespace
}  // namespace grainvdb::testing::free_surface_test
