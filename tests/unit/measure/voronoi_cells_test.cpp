// Voronoi cells of crystals, of unequal pairs and of random packings, and what is made of them.
#include "measure/voronoi_cells.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "grainvdb/moment.hpp"
#include "lattices.hpp"
#include "measure/local_packing.hpp"

namespace grainvdb::testing::voronoi_cells_test {
namespace {

constexpr double pi = std::numbers::pi;

/// Equal cells, whose packing fraction is that of the crystal, at any unit of length.
void expect_packing(Scene s, double phi, double unit) {
  for (auto& column : s.position)
    for (double& x : column) x *= unit;
  for (std::size_t a = 0; a < 3; ++a) {
    s.box.lo[a] *= unit;
    s.box.hi[a] *= unit;
  }
  for (double& r : s.radius) r *= unit;
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  for (std::size_t i = 0; i < s.size(); ++i) {
    // voro++ drops faces below 1e-11 of a diameter, and rounding is of that order.
    EXPECT_NEAR(sphere_volume(s.radius[i]) / cells.volume[i], phi, 1e-9);
    EXPECT_FALSE(cells.at_face[i]);
  }
}

TEST(VoronoiCells, PackCrystalsAsIsKnown) {
  for (const double unit : {1.0, 1e-6, 1e5}) {
    expect_packing(simple_cubic(4), pi / 6, unit);
    expect_packing(face_centred(3), pi / (3 * std::sqrt(2.0)), unit);
    expect_packing(body_centred(4), pi * std::sqrt(3.0) / 8, unit);
  }
  EXPECT_NEAR(pi / (3 * std::sqrt(2.0)), 0.740480, 5e-7);
  EXPECT_NEAR(pi * std::sqrt(3.0) / 8, 0.680175, 5e-7);
}

TEST(VoronoiCells, AreHexagonalPrismsInALayer) {
  const Scene s = hexagonal_layer(5);
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_NEAR(pi / 4 / cells.volume[i], 0.906900, 5e-7);  // discs in hexagons; the prisms are 1 high
    EXPECT_TRUE(cells.at_face[i]);
  }
}

TEST(VoronoiCells, ArePartedAtTheTangentPlaneOfTouchingGrains) {
  Scene s;
  s.box = {{0, 0, 0}, {4, 1, 1}, {false, true, true}};
  s.add({1, 0.5, 0.5}, 0.3);
  s.add({2, 0.5, 0.5}, 0.7);
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  EXPECT_NEAR(cells.volume[0], 1.3, 1e-12);
  EXPECT_NEAR(cells.volume[1], 2.7, 1e-12);
}

TEST(VoronoiCells, FillTheBox) {
  for (const bool periodic : {false, true}) {
    const Box box{{-3, 1, 0}, {4, 7, 9}, {periodic, true, periodic}};
    Scene s = poisson(box, 500, 7);
    Random random(8);
    for (double& r : s.radius) r = random.uniform(0.05, 0.4);
    const VoronoiCells cells = voronoi_cells(box, s.position, s.radius);
    EXPECT_NEAR(std::accumulate(cells.volume.begin(), cells.volume.end(), 0.0), 7 * 6 * 9, 1e-8);
  }
}

TEST(VoronoiCells, ReachTheFaceThatAGrainSitsOn) {
  Scene s;
  s.box = {{0, 0, 0}, {2, 2, 2}, {false, false, false}};
  s.add({2, 1, 1}, 0.5);
  s.add({0, 1, 1}, 0.5);
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  EXPECT_NEAR(cells.volume[0], 4, 1e-12);
  EXPECT_NEAR(cells.volume[1], 4, 1e-12);
}

TEST(CoincidentPair, IsFoundAcrossBoundaries) {
  Scene s = simple_cubic(3);
  EXPECT_FALSE(coincident_pair(s.box, s.position, s.radius));
  s.add({s.position[0][5] + 3, s.position[1][5] - 3, s.position[2][5] + 1e-8}, 0.5);
  const auto pair = coincident_pair(s.box, s.position, s.radius);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->first, 5U);
  EXPECT_EQ(pair->second, 27U);
}

TEST(CommonVolume, IsThatOfTwoBalls) {
  EXPECT_EQ(common_volume(3, 1, 2), 0);
  EXPECT_DOUBLE_EQ(common_volume(0.5, 3, 1), sphere_volume(1));
  EXPECT_NEAR(common_volume(1, 1, 1), 5 * pi / 12, 1e-14);
  // A small ball cut by the nearly flat surface of a large one: half of it.
  EXPECT_NEAR(common_volume(1e6, 1e6, 1), sphere_volume(1) / 2, 1e-4);
}

TEST(LocalPacking, IsThatOfTheCrystalEverywhere) {
  const Scene s = face_centred(4);
  const double phi = pi / (3 * std::sqrt(2.0));
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  const LocalPacking packing(s.box, s.position, s.radius, cells, 2.2);
  Random random(3);
  for (std::size_t i = 0; i < s.size(); i += 5) EXPECT_NEAR(packing.about(i), phi, 1e-9);
  double centres = 0, volume = 0;
  for (int n = 0; n < 200; ++n) {
    const auto w = packing.window({random.uniform(0, 9), random.uniform(0, 9), random.uniform(0, 9)});
    EXPECT_TRUE(w.enclosed);
    EXPECT_NEAR(w.by_cells, phi, 1e-9);
    centres += std::pow(w.by_centres - phi, 2) / 200;
    volume += std::pow(w.by_volume - phi, 2) / 200;
  }
  // As in the lecture: counting centres scatters most, cells not at all.
  EXPECT_GT(std::sqrt(centres), 3 * std::sqrt(volume));
  EXPECT_GT(std::sqrt(volume), 1e-4);
}

TEST(LocalPacking, LeavesOutWindowsAtFaces) {
  const Scene s = hexagonal_layer(6);
  const VoronoiCells cells = voronoi_cells(s.box, s.position, s.radius);
  const LocalPacking packing(s.box, s.position, s.radius, cells, 1);
  EXPECT_FALSE(packing.window({3, 3, 0.5}).enclosed);
  EXPECT_FALSE(packing.is_enclosed(4));
}

TEST(KernelPacking, IsTheFieldOfTheSimpleCubicLattice) {
  const Scene s = simple_cubic(7);
  for (const double phi : kernel_packing(s.box, s.position, s.radius, LucyKernel(3)))
    EXPECT_NEAR(phi, pi / 6, 0.0023 * pi / 6);  // its ripple at c = 3d is -0.062/+0.22 %
}

}  // namespace
}  // namespace grainvdb::testing::voronoi_cells_test
