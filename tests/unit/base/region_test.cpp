#include "grainvdb/region.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace grainvdb::region_test {
namespace {

/// Periodic along x with 20 voxels from -3, open along y and z.
Lattice lattice() {
  Lattice l(1, {0, 0, 0});
  l.set_periods({{-3, -10, -10}, {17, 10, 10}, {true, false, false}});
  return l;
}

using Leaves = std::set<Coord>;

/// The leaves that a region holds around the origin.
Leaves held(const Region& region) {
  Leaves all;
  for (std::int32_t x = -64; x < 64; x += 8)
    for (std::int32_t y = -64; y < 64; y += 8)
      for (std::int32_t z = -64; z < 64; z += 8)
        if (region.holds({x, y, z})) all.insert({x, y, z});
  return all;
}

/// All leaf-sized cells with a voxel within `reach` of a leaf, the distance taken along the axes.
Leaves grown_by_hand(const Leaves& leaves, std::int32_t reach) {
  Leaves all;
  for (const Coord& l : leaves)
    for (std::int32_t x = l.x - reach; x < l.x + 8 + reach; ++x)
      for (std::int32_t y = l.y - reach; y < l.y + 8 + reach; ++y)
        for (std::int32_t z = l.z - reach; z < l.z + 8 + reach; ++z) all.insert(leaf_origin({x, y, z}));
  return all;
}

/// The leaves that hold images of the voxels of leaves.
Leaves wrapped_by_hand(const Leaves& leaves) {
  Leaves all;
  for (const Coord& l : leaves)
    for (int offset = 0; offset < leaf_size; ++offset) all.insert(leaf_origin(lattice().wrap(voxel_at(l, offset))));
  return all;
}

std::vector<Region> regions() {
  return {Region::box(lattice(), Coord{1, 2, 3}, Coord{6, 9, 3}),
          Region::box(lattice(), Coord{15, -5, 0}, Coord{18, 0, 0}),
          Region::box(lattice(), Coord{-100, 0, 0}, Coord{100, 1, 1}),
          Region::leaves({{0, 0, 0}, {16, 8, 0}, {-8, 0, -8}, {0, 0, 0}})};
}

TEST(Region, HoldsTheLeavesItTouches) {
  EXPECT_EQ(held(regions()[0]), (Leaves{{0, 0, 0}, {0, 8, 0}}));
  // Voxels 15, 16 and, wrapped, -3 and -2.
  EXPECT_EQ(held(regions()[1]), (Leaves{{8, -8, 0}, {8, 0, 0}, {16, -8, 0}, {16, 0, 0}, {-8, -8, 0}, {-8, 0, 0}}));
  // A whole period and more: -3 … 16.
  EXPECT_EQ(held(regions()[2]), (Leaves{{-8, 0, 0}, {0, 0, 0}, {8, 0, 0}, {16, 0, 0}}));
  EXPECT_EQ(held(regions()[3]), (Leaves{{0, 0, 0}, {16, 8, 0}, {-8, 0, -8}}));
}

TEST(Region, GrowsByWholeLeaves) {
  for (const Region& region : regions())
    for (std::int32_t reach : {1, 6, 8, 9}) EXPECT_EQ(held(region.grown(reach)), grown_by_hand(held(region), reach));
}

TEST(Region, WrapsIntoThePeriod) {
  for (const Region& region : regions())
    EXPECT_EQ(held(region.grown(5).wrapped(lattice())), wrapped_by_hand(held(region.grown(5))));
}

TEST(Region, CanBeEverywhereAlongAxes) {
  for (const Region& region : regions()) {
    const Region more = region.everywhere_along({true, false, false}).wrapped(lattice());
    for (const Coord& leaf : held(region))
      for (std::int32_t x : {-8, 0, 8, 16}) EXPECT_TRUE(more.holds({x, leaf.y, leaf.z}));
    EXPECT_FALSE(more.holds({24, 0, 0}));
    EXPECT_FALSE(more.holds({0, 48, 0}));
  }
}

TEST(Region, OfPositionsHoldsVoxelCentres) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Topology all({{0, 0, 0}}, {LeafMask{{~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL}}});
  const auto bounds_of = [&](const Vec3& lo, const Vec3& hi) {
    return *Region::box(lattice(), lo, hi).clip(all).bounds();
  };
  // Voxel i has its centre at i + ½; the upper side is left out.
  const auto some = bounds_of({0, 0.5, 1.6}, {1, 2.5, 4.6});
  EXPECT_EQ(some.first, (Coord{0, 0, 2}));
  EXPECT_EQ(some.last, (Coord{0, 1, 4}));
  const auto open = bounds_of({-inf, 3, -inf}, {inf, inf, 3});
  EXPECT_EQ(open.first, (Coord{0, 3, 0}));
  EXPECT_EQ(open.last, (Coord{7, 7, 2}));
  EXPECT_TRUE(Region::box(lattice(), Vec3{0.6, 0, 0}, Vec3{1.4, 5, 5}).empty());
}

TEST(Region, ClipsVoxelByVoxel) {
  std::mt19937 random(3);
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (std::int32_t x : {-8, 0, 8, 16})
    for (std::int32_t y : {-8, 0, 8}) {
      LeafMask mask;
      for (int v = 0; v < leaf_size; ++v)
        if (random() % 3 > 0 && lattice().contains(0, voxel_at({x, y, 0}, v).x)) mask.set(v);
      origins.push_back({x, y, 0});
      masks.push_back(mask);
    }
  const Topology all(origins, masks);
  const Topology part = regions()[1].clip(all);
  std::size_t wanted = 0;
  for (std::size_t l = 0; l < all.leaf_count(); ++l)
    all.mask(l).for_each([&](int v) {
      const Coord c = voxel_at(all.origin(l), v);
      const bool is_wanted = (c.x >= 15 || c.x <= -2) && c.y >= -5 && c.y <= 0 && c.z == 0;
      wanted += is_wanted ? 1 : 0;
      const auto leaf = part.find(all.origin(l));
      EXPECT_EQ(leaf && part.mask(*leaf).test(v), is_wanted);
    });
  EXPECT_EQ(part.active_voxel_count(), wanted);

  const Topology leaves = regions()[3].clip(all);
  EXPECT_EQ(leaves.origins(), (std::vector<Coord>{{0, 0, 0}, {16, 8, 0}}));
  EXPECT_EQ(leaves.mask(0), all.mask(*all.find({0, 0, 0})));
}

TEST(Region, ClipsBoxes) {
  const Region region = Region::box(lattice(), Coord{0, -5, 2}, Coord{3, 40, 4});
  const auto box = region.clip(Topology::Bounds{{-3, 0, 0}, {16, 9, 3}});
  ASSERT_TRUE(box);
  EXPECT_EQ(box->first, (Coord{0, 0, 2}));
  EXPECT_EQ(box->last, (Coord{3, 9, 3}));
  EXPECT_FALSE(region.clip(Topology::Bounds{{-3, 0, 5}, {16, 9, 9}}));
}

}  // namespace
}  // namespace grainvdb::region_test
