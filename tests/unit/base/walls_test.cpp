#include "grainvdb/walls.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "base/vec3.hpp"

namespace grainvdb::walls_test {
namespace {

using Shape = Wall::Shape;

Wall plane(const Vec3& point, const Vec3& normal) {
  return {Shape::plane, point, normal};
}

/// The sum of W over the centres of small cubes that lie in the domain, over the same sum without walls. The cubes at a
/// wall count as a whole or not: some 3 n² of them with a random error of W/2 each, 2e-4 of the total for n = 60.
double counted(const LucyKernel& kernel, const WallDomain& domain, const Vec3& x) {
  constexpr int n = 60;
  const double c = kernel.cutoff();
  double inside = 0, all = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 d{c * (2 * (i + 0.5) / n - 1), c * (2 * (j + 0.5) / n - 1), c * (2 * (k + 0.5) / n - 1)};
        const double w = kernel.value(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        all += w;
        if (w > 0 && domain.contains({x[0] + d[0], x[1] + d[1], x[2] + d[2]})) inside += w;
      }
  return inside / all;
}
constexpr double count_error = 1e-3;

TEST(WallDomain, WithoutWallsEverythingIsInside) {
  const WallDomain none;
  EXPECT_EQ(none.distance({1, 2, 3}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(none.contains({1, 2, 3}));
  EXPECT_EQ(none.inside_fraction(LucyKernel(2), {1, 2, 3}), 1);
}

// Physics section 6, with the digits given there, and the same beyond the plane.
TEST(WallDomain, PartOfTheKernelBesideAPlane) {
  const double c = 2.4e-3;
  const LucyKernel kernel(c);
  const WallDomain wall({plane({0.01, 0.02, 0.03}, {0, 3, 4})});
  const auto fraction = [&](double distance) {
    return wall.inside_fraction(kernel, {0.4, 0.02 + 0.6 * distance * c, 0.03 + 0.8 * distance * c});
  };
  EXPECT_NEAR(fraction(0), 0.5, 1e-12);
  EXPECT_NEAR(fraction(0.1), 0.629, 5e-4);
  EXPECT_NEAR(fraction(0.25), 0.797, 5e-4);
  EXPECT_NEAR(fraction(0.5), 0.9585, 5e-5);
  EXPECT_NEAR(fraction(0.75), 0.9981, 5e-5);
  EXPECT_EQ(fraction(1.01), 1);
  EXPECT_NEAR(fraction(-0.25), 1 - fraction(0.25), 1e-12);
  EXPECT_EQ(fraction(-1.01), 0);
}

TEST(WallDomain, PlanesThatFaceEachOtherCutApart) {
  const LucyKernel kernel(1);
  const WallDomain gap({plane({0, 0, 0}, {0, 0, 1}), plane({0, 0, 0.8}, {0, 0, -1})});
  for (double z : {0.0, 0.1, 0.4, 0.75})
    EXPECT_NEAR(gap.inside_fraction(kernel, {5, 6, z}), kernel.marginal_integral(z) + kernel.marginal_integral(0.8 - z),
                1e-12);
}

// By quadrature, against counting. The walls are told apart from the exact planes by a cylinder far larger than the
// kernel, whose wall is one.
TEST(WallDomain, PartOfTheKernelBesideOtherWalls) {
  const LucyKernel kernel(1);
  const Wall tube{Shape::cylinder, {1, 2, 3}, {0, 0, 2}, 1.5};
  const Wall column{Shape::cylinder, {1, 2, 3}, {0, 0, 2}, 0.7, 0, false};
  const Wall hopper{Shape::cone, {0, 0, 0}, {0, 0, 1}, 0, 0.6};
  const Wall spike{Shape::cone, {0, 0, 0}, {0, 0, 1}, 0, 0.4, false};
  struct Case {
    std::vector<Wall> walls;
    Vec3 x;
  };
  for (const Case& k :
       {Case{{tube}, {1, 2, 7}}, Case{{tube}, {2.1, 2.5, 0}}, Case{{tube}, {2.4, 2.4, 0}}, Case{{column}, {1.8, 2, 3}},
        Case{{column}, {1, 2.95, -3}}, Case{{hopper}, {0.1, 0, 0.4}}, Case{{hopper}, {0.5, 0.6, 2}},
        Case{{hopper}, {0, 0, 0.1}}, Case{{spike}, {0.3, 0.5, 0.8}}, Case{{spike}, {0, 0.1, -0.5}},
        Case{{plane({0, 0, 0}, {1, 0, 0}), plane({0, 0, 0}, {0, 1, 0})}, {0.2, 0.1, 4}},
        Case{{plane({0, 0, 0}, {1, 0, 0}), plane({0, 0, 0}, {0, 1, 0}), plane({0, 0, 0}, {0, 0, 1})}, {0.3, 0.4, 0.2}},
        Case{{tube, plane({0, 0, 3}, {0, 0, 1})}, {2.2, 2.3, 3.2}}}) {
    const WallDomain domain(k.walls);
    EXPECT_NEAR(domain.inside_fraction(kernel, k.x), counted(kernel, domain, k.x), 4e-3 + count_error)
        << k.x[0] << ' ' << k.x[1] << ' ' << k.x[2];
  }
  const WallDomain wide({{Shape::cylinder, {0, 1e6, 0}, {1, 0, 0}, 1e6}});
  for (double y : {0.0, 0.1, 0.25, 0.5, 0.75})
    EXPECT_NEAR(wide.inside_fraction(kernel, {3, y, 0}), 0.5 + kernel.marginal_integral(y), 1e-5);
}

TEST(WallDomain, DistancesFromEachShape) {
  const WallDomain tube({{Shape::cylinder, {1, 0, 0}, {0, 5, 0}, 2}});
  EXPECT_NEAR(tube.distance({1, 7, 0}), 2, 1e-15);
  EXPECT_NEAR(tube.distance({2, 7, 0}), 1, 1e-15);
  EXPECT_NEAR(tube.distance({1, 7, -5}), -3, 1e-15);
  const WallDomain column({{Shape::cylinder, {1, 0, 0}, {0, 5, 0}, 2, 0, false}});
  EXPECT_NEAR(column.distance({1, 7, -5}), 3, 1e-15);
  EXPECT_FALSE(column.contains({1, 0, 0.5}));
  const double angle = std::numbers::pi / 6;
  const WallDomain cone({{Shape::cone, {0, 0, 1}, {0, 0, 1}, 0, angle}});
  EXPECT_NEAR(cone.distance({0, 0, 3}), 1, 1e-15);  // 2 sin 30°
  EXPECT_NEAR(cone.distance({0, 4, 1}), -4 * std::cos(angle), 1e-15);
  EXPECT_NEAR(cone.distance({0, 0, -1}), -2, 1e-15);  // the apex is nearest
  const WallDomain both({{Shape::cone, {0, 0, 1}, {0, 0, 1}, 0, angle}, plane({0, 0, 4}, {0, 0, -1})});
  EXPECT_NEAR(both.distance({0, 0, 3}), 1, 1e-15);
  EXPECT_NEAR(both.distance({0, 0, 3.5}), 0.5, 1e-15);
}

// The plane that touches a wall next to a point is as far from the point as the wall.
TEST(HalfSpaceAt, TouchesTheWallNextToAPoint) {
  const WallDomain shapes({plane({0, 0, 2}, {0, 3, 4}),
                           {Shape::cylinder, {1, 0, 0}, {0, 5, 0}, 2},
                           {Shape::cylinder, {1, 0, 0}, {0, 5, 0}, 0.5, 0, false},
                           {Shape::cone, {0, 0, -3}, {0, 0, 1}, 0, 0.5},
                           {Shape::cone, {0, 1, 1}, {1, 0, 1}, 0, 0.4, false}});
  const Vec3 x{1.8, 0.3, -0.4}, behind{-1, 1, 0};
  for (const Wall& wall : shapes.walls()) {
    const HalfSpace side = half_space_at(wall, x);
    EXPECT_NEAR(dot(side.normal, side.normal), 1, 1e-15);
    EXPECT_NEAR(dot(side.normal, x) - side.offset, WallDomain({wall}).distance(x), 1e-14);
  }
  const HalfSpace tip = half_space_at(shapes.walls().back(), behind);
  EXPECT_NEAR(dot(tip.normal, behind) - tip.offset, std::sqrt(2.0), 1e-14);
}

TEST(WallDomain, RefusesShapesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(WallDomain({plane({0, 0, 0}, {0, 0, 0})}), std::invalid_argument);
  EXPECT_THROW(WallDomain({plane({0, 0, 0}, {0, nan, 0})}), std::invalid_argument);
  EXPECT_THROW(WallDomain({{Shape::cylinder, {0, 0, 0}, {0, 0, 1}, 0}}), std::invalid_argument);
  EXPECT_THROW(WallDomain({{Shape::cone, {0, 0, 0}, {0, 0, 1}, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(WallDomain({{Shape::cone, {0, 0, 0}, {0, 0, 1}, 0, 1.6}}), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::walls_test
