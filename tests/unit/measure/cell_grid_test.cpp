// The neighbour search against all pairs and images.
#include "measure/cell_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::cell_grid_test {
namespace {

using Found = std::tuple<std::size_t, double, double, double>;  // of which point, and where its image is

std::vector<Found> all_images(const Scene& s, std::size_t i, double reach) {
  std::vector<Found> found;
  const auto images = [&](int a) {
    return s.box.periodic[a] ? static_cast<int>(std::ceil(reach / s.box.length(a))) + 1 : 0;
  };
  for (std::size_t j = 0; j < s.size(); ++j)
    for (int x = -images(0); x <= images(0); ++x)
      for (int y = -images(1); y <= images(1); ++y)
        for (int z = -images(2); z <= images(2); ++z) {
          const int shift[3] = {x, y, z};
          Vec3 r{};
          for (int a = 0; a < 3; ++a) r[a] = s.position[a][j] + shift[a] * s.box.length(a) - s.position[a][i];
          if (i == j && x == 0 && y == 0 && z == 0) continue;
          if (std::hypot(r[0], r[1], r[2]) <= reach) found.emplace_back(j, r[0], r[1], r[2]);
        }
  std::sort(found.begin(), found.end());
  return found;
}

void expect_all_found(const Scene& s, double reach) {
  const CellGrid grid(s.box, s.position, reach);
  for (std::size_t i = 0; i < s.size(); ++i) {
    std::vector<Found> found;
    grid.neighbours(i, [&](std::size_t j, const Vec3& r, double r2) {
      EXPECT_DOUBLE_EQ(std::sqrt(r2), std::hypot(r[0], r[1], r[2]));
      found.emplace_back(j, r[0], r[1], r[2]);
    });
    std::sort(found.begin(), found.end());
    const std::vector<Found> expected = all_images(s, i, reach);
    ASSERT_EQ(found.size(), expected.size()) << "point " << i << ", reach " << reach;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(std::get<0>(found[k]), std::get<0>(expected[k]));
      EXPECT_NEAR(std::get<1>(found[k]), std::get<1>(expected[k]), 1e-12);
    }
  }
}

const Box mixed{{-1, 2, -3}, {4, 5, 4}, {true, false, true}};

TEST(CellGrid, FindsEveryImageWithinReach) {
  // From far below a cell of its own to several periods of the box.
  for (const double reach : {0.01, 0.7, 1.6, 2.9, 8.0}) expect_all_found(poisson(mixed, 60, 1), reach);
}

TEST(CellGrid, FindsNeighboursOfPointsThatLieOutsideThePeriodicBox) {
  Scene s = poisson(mixed, 60, 2);
  const CellGrid inside(s.box, s.position, 1.2);
  for (std::size_t i = 0; i < s.size(); i += 3) {
    s.position[0][i] += 3 * s.box.length(0);
    s.position[2][i] -= s.box.length(2);
  }
  const CellGrid outside(s.box, s.position, 1.2);
  for (std::size_t i = 0; i < s.size(); ++i) {
    std::size_t a = 0, b = 0;
    inside.neighbours(i, [&](std::size_t j, const Vec3&, double) { a += j + 1; });
    outside.neighbours(i, [&](std::size_t j, const Vec3&, double) { b += j + 1; });
    EXPECT_EQ(a, b);
  }
}

TEST(CellGrid, FindsPointsThatLieInAPlaneOrFarFromAllOthers) {
  Scene plane = poisson(mixed, 40, 3);
  std::fill(plane.position[1].begin(), plane.position[1].end(), 2.5);
  expect_all_found(plane, 1.1);
  Scene stray = poisson(mixed, 40, 4);
  stray.position[1][7] = 1e9;  // as many cells as fit in between would not fit into memory
  expect_all_found(stray, 0.9);
}

TEST(CellGrid, ServesBoxesWithoutPoints) {
  const CellGrid grid(mixed, Columns3{}, 1);
  grid.around({0, 3, 0}, [](std::size_t, const Vec3&, double) { FAIL(); });
}

TEST(CellGrid, RefusesWhatHasNoPlace) {
  Scene s = poisson(mixed, 3, 5);
  EXPECT_THROW(CellGrid(s.box, s.position, 0), std::invalid_argument);
  s.position[1][1] = std::nan("");
  EXPECT_THROW(CellGrid(s.box, s.position, 1), std::invalid_argument);
}

TEST(CellCounts, AreBoundedInNumberAndWidth) {
  using Counts = std::array<std::int64_t, 3>;
  EXPECT_EQ(cell_counts({10, 5.5, 0.1}, 1, 100), (Counts{10, 5, 1}));
  EXPECT_EQ(cell_counts({0, 0, 0}, 1, 1), (Counts{1, 1, 1}));
  const Counts few = cell_counts({1e9, 1, 1}, 1e-3, 70);
  EXPECT_LE(few[0] * few[1] * few[2], 70);
  EXPECT_GT(few[0], 50);
}

TEST(NearestImage, IsOneOfAll) {
  const Box box{{0, 0, 0}, {2, 2, 2}, {true, false, true}};
  EXPECT_TRUE(is_nearest_image(box, {-1, 5, 0}));
  EXPECT_FALSE(is_nearest_image(box, {1, 0, 0}));
  EXPECT_FALSE(is_nearest_image(box, {0, 0, -1.1}));
}

}  // namespace
}  // namespace grainvdb::testing::cell_grid_test
