// Voronoi cells that end at walls: crystals between planes, straight and tilted, and grains within and around curved
// walls.
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "grainvdb/moment.hpp"
#include "lattices.hpp"
#include "measure/voronoi_cells.hpp"

namespace grainvdb::testing::voronoi_walls_test {
namespace {

constexpr double pi = std::numbers::pi;
using Shape = Wall::Shape;

Wall plane(const Vec3& point, const Vec3& normal) {
  return {Shape::plane, point, normal};
}

std::vector<Wall> faces_of(const Box& box) {
  std::vector<Wall> walls;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 inward{};
    inward[a] = 1;
    walls.push_back(plane(box.lo, inward));
    inward[a] = -1;
    walls.push_back(plane(box.hi, inward));
  }
  return walls;
}

double total(const VoronoiCells& cells) {
  return std::accumulate(cells.volume.begin(), cells.volume.end(), 0.0);
}

/// Grains at random within walls, of unequal radii.
Scene scattered(const Box& box, const WallDomain& walls, std::size_t n, std::uint64_t seed) {
  const Scene everywhere = poisson(box, n, seed);
  Random random(seed + 1);
  Scene s;
  s.box = box;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x{everywhere.position[0][i], everywhere.position[1][i], everywhere.position[2][i]};
    if (walls.contains(x)) s.add(x, random.uniform(0.2, 0.6));
  }
  return s;
}

TEST(VoronoiWalls, CutTheOuterLayersOfASimpleCubicCrystal) {
  Scene s;
  s.box = {{0, 0, 0}, {4, 4, 5}, {true, true, false}};  // ends at the outermost centres, as LAMMPS shrinks it
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 6; ++k) s.add({i + 0.5, j + 0.5, static_cast<double>(k)}, 0.5);
  const WallDomain walls({plane({0, 0, -0.5}, {0, 0, 1}), plane({0, 0, 5.5}, {0, 0, -3})});
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius, walls);
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_NEAR(sphere_volume(0.5) / cells.volume[i], pi / 6, 1e-9);
    EXPECT_FALSE(cells.at_face[i]);
    EXPECT_EQ(cells.at_wall[i], s.position[2][i] < 0.5 || s.position[2][i] > 4.5);
  }
}

TEST(VoronoiWalls, AtOneSideLeaveTheOtherOpen) {
  Scene s = hexagonal_layer(5);
  const VoronoiCells between = voronoi_cells(s.box, s.position, s.radius,
                                             WallDomain({plane({0, 0, 0}, {0, 0, 1}), plane({9, 9, 1}, {0, 0, -1})}));
  const VoronoiCells above = voronoi_cells(s.box, s.position, s.radius, WallDomain({plane({0, 0, 0}, {0, 0, 1})}));
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_NEAR(pi / 4 / between.volume[i], 0.906900, 5e-7);
    EXPECT_TRUE(between.at_wall[i] && !between.at_face[i]);
    EXPECT_TRUE(above.at_wall[i] && above.at_face[i]);
  }
}

// Layers across [001]. Seen along it, the cell of a grain is the unit square of its four neighbours in the layer. Half
// of the rhombic dodecahedron, a volume of sqrt(2)/4, lies below the middle of a grain in the uppermost layer; above it
// there is a prism up to the wall, which touches the grain.
TEST(VoronoiWalls, CutTheOuterLayersOfAFaceCentredCrystal) {
  Scene s = face_centred(3);
  const double edge = std::sqrt(2.0);
  s.box.periodic[2] = false;
  const double top = 2.5 * edge;
  const WallDomain walls({plane({0, 0, -0.5}, {0, 0, 1}), plane({0, 0, top + 0.5}, {0, 0, -1})});
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius, walls);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const bool outer = s.position[2][i] < 0.1 || s.position[2][i] > top - 0.1;
    EXPECT_NEAR(cells.volume[i], outer ? edge / 4 + 0.5 : edge / 2, 1e-9);
    EXPECT_EQ(cells.at_wall[i], outer);
  }
}

// A block of a simple cubic crystal, turned by 3-4-5 triangles about two axes, between six planes that touch it.
TEST(VoronoiWalls, MayBeTilted) {
  const Vec3 u{0.8, 0.6, 0}, v{-0.6 * 0.8, 0.8 * 0.8, 0.6}, w{0.6 * 0.6, -0.8 * 0.6, 0.8};
  const auto turned = [&](double a, double b, double c) {
    return Vec3{a * u[0] + b * v[0] + c * w[0], a * u[1] + b * v[1] + c * w[1], a * u[2] + b * v[2] + c * w[2]};
  };
  Scene s;
  s.box = {{-4, -4, -4}, {6, 6, 6}, {false, false, false}};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 5; ++k) s.add(turned(i, j, k), 0.5);
  const Vec3 low = turned(-0.5, -0.5, -0.5), high = turned(3.5, 2.5, 4.5);
  std::vector<Wall> walls;
  for (const Vec3& n : {u, v, w}) {
    walls.push_back(plane(low, n));
    walls.push_back(plane(high, {-n[0], -n[1], -n[2]}));
  }
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius, WallDomain(walls));
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_NEAR(cells.volume[i], 1, 1e-9);
    EXPECT_FALSE(cells.at_face[i]);
  }
}

// A box less the corner that a plane across its diagonal takes off.
TEST(VoronoiWalls, CellsFillTheRoomBetweenPlanes) {
  const Box box{{-1, 2, 0}, {5, 8, 6}, {false, false, false}};
  std::vector<Wall> planes = faces_of(box);
  planes.push_back(plane({5 - 4.5, 8, 6}, {-1, -1, -1}));
  const WallDomain walls(planes);
  const Scene s = scattered(box, walls, 700, 5);
  const double room = 6 * 6 * 6 - 4.5 * 4.5 * 4.5 / 6;
  EXPECT_NEAR(total(voronoi_cells(s.box, s.position, s.radius, walls)), room, 1e-9 * room);
}

// The planes that touch the wall leave a ring between it and them: all of it is outside.
void expect_slightly_more(double found, double room, double excess) {
  EXPECT_GT(found, room);
  EXPECT_LT(found, room * (1 + excess));
}

TEST(VoronoiWalls, OfACylinderLeaveItsVolumeToASingleGrain) {
  const Wall tube{Shape::cylinder, {1, 2, 3}, {0, 0, 2}, 2};
  const WallDomain walls({tube, plane({0, 0, 3}, {0, 0, 1}), plane({0, 0, 5}, {0, 0, -1})});
  const double room = pi * 4 * 2;
  for (const double off : {0.0, 1e-4, 0.3, 1.5}) {
    Scene s;
    s.box = {{-2, -1, 0}, {4, 5, 7}, {false, false, false}};
    s.add({1 + off, 2, 4.5}, 0.5);
    const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius, walls);
    // The ring is at most 1e-4 of the cube root of the room wide at corners of the polygon, a third of it on average.
    expect_slightly_more(cells.volume[0], room, 1e-4 * std::cbrt(room) / 2 * 2 / 3);
    EXPECT_TRUE(cells.at_wall[0] && !cells.at_face[0]);
  }
}

TEST(VoronoiWalls, CellsFillACylinderAcrossAndACone) {
  const Box box{{-3, -3, 0}, {3, 3, 6}, {false, false, false}};
  const WallDomain lying({{Shape::cylinder, {0, 0, 3}, {0.6, 0.8, 0}, 2.5},
                          plane({-1, 0, 3}, {0.6, 0.8, 0}),
                          plane({1, 0, 3}, {-0.6, -0.8, 0})});
  Scene s = scattered(box, lying, 1500, 6);
  expect_slightly_more(total(voronoi_cells(s.box, s.position, s.radius, lying)), pi * 2.5 * 2.5 * 1.2, 1e-4);
  const WallDomain hopper({{Shape::cone, {0, 0, -1}, {0, 0, 1}, 0, 0.5}, plane({0, 0, 5}, {0, 0, -1})});
  s = scattered({{-4, -4, -1}, {4, 4, 5}, {false, false, false}}, hopper, 3000, 8);
  expect_slightly_more(total(voronoi_cells(s.box, s.position, s.radius, hopper)),
                       pi * 216 * std::pow(std::tan(0.5), 2) / 3, 1e-4);
}

// A ring of grains between a column and a tube. One plane for each grain takes off what the column curves away from it:
// the triangle under the plane in place of the sector under the arc, about w³/(24 R) for a cell of width w.
TEST(VoronoiWalls, AroundAColumnTakeTooMuch) {
  constexpr double radius = 3;
  constexpr int n = 22;
  Scene s;
  s.box = {{-5, -5, 0}, {5, 5, 1}, {false, false, true}};
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * pi * (i + 0.3) / n;
    s.add({(radius + 0.5) * std::cos(angle), (radius + 0.5) * std::sin(angle), 0.5}, 0.5);
  }
  const WallDomain walls(
      {{Shape::cylinder, {0, 0, 0}, {0, 0, 1}, radius, 0, false}, {Shape::cylinder, {0, 0, 0}, {0, 0, 1}, radius + 1}});
  const double outer = pi * std::pow(radius + 1, 2) / n;
  const double kept = outer - std::pow(radius, 2) * std::tan(pi / n);
  const double width = 2 * pi * radius / n;
  EXPECT_NEAR(outer - pi * radius * radius / n - kept, std::pow(width, 3) / (24 * radius), 2e-4);
  for (const double volume : voronoi_cells(s.box, s.position, s.radius, walls).volume)
    expect_slightly_more(volume, kept, 1e-4);
}

// Behind the apex of a spike the apex is nearest: a grain on its axis keeps what is below.
TEST(VoronoiWalls, BehindASpikeEndAtItsTip) {
  Scene s;
  s.box = {{0, 0, 0}, {2, 2, 4}, {false, false, false}};
  s.add({1, 1, 0.5}, 0.5);
  std::vector<Wall> walls = faces_of({{0, 0, 0}, {2, 2, 4}, {}});
  walls.push_back({Shape::cone, {1, 1, 3}, {0, 0, 1}, 0, 0.4, false});
  EXPECT_NEAR(voronoi_cells(s.box, s.position, s.radius, WallDomain(walls)).volume[0], 12, 1e-9);
}

}  // namespace
}  // namespace grainvdb::testing::voronoi_walls_test
