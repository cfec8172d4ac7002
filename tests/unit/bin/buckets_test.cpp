#include "bin/buckets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

#include "grainvdb/topology.hpp"

namespace grainvdb::buckets_test {
namespace {

Lattice lattice_of(double h, const Vec3& origin, const Box& box) {
  Lattice lattice(h, origin);
  lattice.set_periods(box);
  return lattice;
}

Columns3 points(const std::vector<Vec3>& x) {
  Columns3 columns;
  for (const Vec3& p : x)
    for (std::size_t a = 0; a < 3; ++a) columns[a].push_back(p[a]);
  return columns;
}

// The images that a point has, as sorted index positions.
std::vector<Vec3> images(const Buckets& b, std::uint32_t point) {
  std::vector<Vec3> result;
  for (std::size_t e = 0; e < b.point.size(); ++e)
    if (b.point[e] == point) result.push_back({b.index[0][e], b.index[1][e], b.index[2][e]});
  std::sort(result.begin(), result.end());
  return result;
}

void expect_well_formed(const Buckets& b) {
  ASSERT_EQ(b.start.size(), b.cells.size() + 1);
  EXPECT_EQ(b.start.front(), 0u);
  EXPECT_EQ(b.start.back(), b.point.size());
  for (const auto& column : b.index) ASSERT_EQ(column.size(), b.point.size());
  ASSERT_EQ(b.eighth.size(), 8 * b.cells.size() + 1);
  EXPECT_EQ(b.eighth.back(), b.point.size());
  for (std::size_t c = 0; c < b.cells.size(); ++c) {
    EXPECT_TRUE(c == 0 || b.cells[c - 1] < b.cells[c]);
    EXPECT_LT(b.start[c], b.start[c + 1]);
    for (std::size_t e = b.start[c]; e < b.start[c + 1]; ++e) {
      // The voxel that holds the entry belongs to the cell's leaf.
      const auto voxel = [&](std::size_t a) { return static_cast<std::int32_t>(std::floor(b.index[a][e] + 0.5)); };
      EXPECT_EQ(leaf_origin({voxel(0), voxel(1), voxel(2)}), b.cells[c]);
    }
    EXPECT_EQ(b.eighth[8 * c], b.start[c]);
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t e = b.eighth[8 * c + n]; e < b.eighth[8 * c + n + 1]; ++e) {
        EXPECT_TRUE(e == b.eighth[8 * c + n] || b.point[e - 1] <= b.point[e]);
        for (std::size_t a = 0; a < 3; ++a)
          EXPECT_EQ(b.index[a][e] + 0.5 >= b.cells[c][static_cast<int>(a)] + 4, ((n >> (2 - a)) & 1U) == 1) << n;
      }
  }
}

TEST(Buckets, OfNoPointsAreEmpty) {
  const Buckets b = bin_points(Lattice(1, {0, 0, 0}), {}, 3);
  expect_well_formed(b);
  EXPECT_TRUE(b.cells.empty());
}

TEST(Buckets, OpenBoxHasOneEntryPerPointInItsLeaf) {
  const Lattice lattice(0.5, {1, 0, 0});
  const Buckets b = bin_points(lattice, points({{1.25, 0.25, 0.25}, {-40, 3, 1000}, {1.3, 0.3, 0.3}}), 2);
  expect_well_formed(b);
  ASSERT_EQ(b.point.size(), 3u);
  EXPECT_EQ(images(b, 0), (std::vector<Vec3>{{0, 0, 0}}));
  EXPECT_EQ(images(b, 1), (std::vector<Vec3>{{-82.5, 5.5, 1999.5}}));
  EXPECT_EQ(b.cells, (std::vector<Coord>{{-88, 0, 2000}, {0, 0, 0}}));  // index 1999.5 belongs to voxel 2000
}

// The images of a point are those, and only those, whose support can touch a voxel of the period.
TEST(Buckets, ImagesAreThoseWithinReachOfThePeriod) {
  const Box box{{-1, 0, 0}, {9, 7, 5}, {true, false, true}};
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-30, 30);
  for (const Vec3 origin : {Vec3{0, 0, 0}, Vec3{0.3, -0.7, 12.45}})
    for (double reach : {0.0, 0.4, 2.0, 3.7, 13.0}) {
      const Lattice lattice = lattice_of(0.5, origin, box);
      std::vector<Vec3> x;
      for (int k = 0; k < 60; ++k) x.push_back({uniform(random), uniform(random), uniform(random)});
      const Buckets b = bin_points(lattice, points(x), reach);
      expect_well_formed(b);
      for (std::uint32_t p = 0; p < x.size(); ++p) {
        std::vector<Vec3> expected;
        const double r = reach / 0.5;
        for (int i = -20; i <= 20; ++i)
          for (int k = -20; k <= 20; ++k) {
            const Vec3 u{lattice.to_index(0, x[p][0]) + 20 * i, lattice.to_index(1, x[p][1]),
                         lattice.to_index(2, x[p][2]) + 10 * k};
            bool near = true;
            for (int a : {0, 2}) {
              const auto& period = *lattice.period(a);
              near = near && u[static_cast<std::size_t>(a)] + r >= period.first &&
                     u[static_cast<std::size_t>(a)] - r <= period.first + period.count - 1;
            }
            if (near) expected.push_back(u);
          }
        std::sort(expected.begin(), expected.end());
        const auto found = images(b, p);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t e = 0; e < found.size(); ++e)
          for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(found[e][a], expected[e][a], 1e-11);
      }
    }
}

TEST(Buckets, PositionAtTheUpperBoundIsThatAtTheLower) {
  const Lattice lattice = lattice_of(0.5, {0, 0, 0}, {{0, 0, 0}, {8, 8, 8}, {true, true, true}});
  const Buckets lower = bin_points(lattice, points({{0, 3, 3}}), 1.5);
  const Buckets upper = bin_points(lattice, points({{8, 3, 3}}), 1.5);
  EXPECT_EQ(lower.cells, upper.cells);
  EXPECT_EQ(lower.index, upper.index);
  EXPECT_EQ(lower.point.size(), 2u);  // both sides of the seam
}

TEST(Buckets, PositionsOutsideTheBoxAndManyPeriodsAwayWrap) {
  const Lattice lattice = lattice_of(0.5, {0, 0, 0}, {{0, 0, 0}, {8, 8, 8}, {true, true, false}});
  const Buckets inside = bin_points(lattice, points({{7.75, 0.5, 3}}), 1.5);
  for (const Vec3& shifted : {Vec3{-0.25, 0.5, 3}, Vec3{7.75 + 8 * 4096, 0.5 - 8 * 512, 3}, Vec3{-8.25, 8.5, 3}}) {
    const Buckets b = bin_points(lattice, points({shifted}), 1.5);
    EXPECT_EQ(b.cells, inside.cells);
    EXPECT_EQ(b.index, inside.index);
  }
}

TEST(Buckets, PeriodShorterThanTheReachHasSeveralImages) {
  const Lattice lattice = lattice_of(1, {0, 0, 0}, {{0, 0, 0}, {2, 50, 50}, {true, false, false}});
  const Buckets b = bin_points(lattice, points({{0.5, 5, 5}}), 5);
  // index 0 ± 2k with |u| - 5 ≤ the voxels 0 and 1: -4 … 6
  std::vector<double> x;
  for (const Vec3& u : images(b, 0)) x.push_back(u[0]);
  EXPECT_EQ(x, (std::vector<double>{-4, -2, 0, 2, 4, 6}));
}

TEST(Buckets, SortHoldsOverWideRanges) {
  // More than 2¹⁶ cells along an axis: two digits of the sort.
  const Lattice lattice(1, {0, 0, 0});
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> wide(-9e8, 9e8), narrow(-100, 100);
  std::vector<Vec3> x;
  for (int k = 0; k < 3000; ++k)
    x.push_back({wide(random), narrow(random), k % 3 == 0 ? wide(random) : narrow(random)});
  const Buckets b = bin_points(lattice, points(x), 3);
  expect_well_formed(b);
  EXPECT_EQ(std::set<std::uint32_t>(b.point.begin(), b.point.end()).size(), x.size());
}

TEST(Buckets, RefusesWhatCannotBeIndexed) {
  const Lattice lattice(1, {0, 0, 0});
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 3e9, -3e9};
  for (double x : bad) EXPECT_THROW(bin_points(lattice, points({{0, x, 0}}), 1), std::invalid_argument) << x;
  for (double reach : {-1.0, bad[0], bad[1], 2e9})
    EXPECT_THROW(bin_points(lattice, points({{0, 0, 0}}), reach), std::invalid_argument) << reach;
  const Lattice periodic = lattice_of(1, {0, 0, 0}, {{0, 0, 0}, {8, 8, 8}, {true, true, true}});
  EXPECT_THROW(bin_points(periodic, points({{0, bad[0], 0}}), 1), std::invalid_argument);
  EXPECT_THROW(bin_points(periodic, points({{0, bad[1], 0}}), 1), std::invalid_argument);
}

// What is kept is what a search for these points alone finds, to the last bit.
TEST(Buckets, KeepSomePoints) {
  Box box;
  box.hi = {4, 4, 4};
  box.periodic = {true, true, false};
  const Lattice lattice = lattice_of(0.25, {0, 0, 0}, box);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 4);
  std::vector<Vec3> all, some;
  std::vector<int> number;
  for (int p = 0; p < 300; ++p) {
    all.push_back({place(random), place(random), place(random)});
    number.push_back(p % 7 == 0 ? 2 : p % 3 - 1);
    if (number.back() == 2) some.push_back(all.back());
  }
  const Buckets kept = keep_points(bin_points(lattice, points(all), 0.6), number, 2);
  const Buckets expected = bin_points(lattice, points(some), 0.6);
  expect_well_formed(kept);
  EXPECT_EQ(kept.cells, expected.cells);
  EXPECT_EQ(kept.start, expected.start);
  EXPECT_EQ(kept.point, expected.point);
  EXPECT_EQ(kept.index, expected.index);
  EXPECT_EQ(kept.local, expected.local);
  EXPECT_EQ(keep_points(expected, std::vector<int>(some.size(), -1), 0).start, std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace grainvdb::buckets_test
