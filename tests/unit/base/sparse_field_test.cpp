#include "grainvdb/sparse_field.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/grids.hpp"

namespace grainvdb::sparse_field_test {
namespace {

std::shared_ptr<const Topology> two_leaves() {
  LeafMask a, b;
  a.set(leaf_offset({-1, 2, 3}));
  a.set(leaf_offset({-4, 2, 3}));
  b.set(leaf_offset({4096, 0, 7}));
  return std::make_shared<const Topology>(std::vector<Coord>{{4096, 0, 0}, {-8, 0, 0}}, std::vector<LeafMask>{b, a});
}

SparseField make(const std::shared_ptr<const Topology>& topology, int components, float background) {
  FieldMeta meta;
  meta.name = "velocity";
  meta.unit = "m/s";
  meta.components = components;
  meta.background = background;
  return SparseField(meta, topology, Lattice(0.5, {1, 2, 3}));
}

TEST(SparseField, LeavesAreWrittenAndReadBack) {
  const auto topology = two_leaves();
  SparseField f = make(topology, 3, 0);
  for (std::size_t l = 0; l < 2; ++l)
    for (int c = 0; c < 3; ++c)
      topology->mask(l).for_each(
          [&](int o) { f.leaf(l, c)[o] = static_cast<float>(100 * l + 10 * static_cast<std::size_t>(c) + 1); });
  EXPECT_EQ(f.value({-1, 2, 3}, 2), 21);
  EXPECT_EQ(f.value({-4, 2, 3}, 0), 1);
  EXPECT_EQ(f.value({4096, 0, 7}, 1), 111);
  EXPECT_EQ(f.value({0, 0, 0}, 1), 0);
}

TEST(SparseField, StartsAtTheBackground) {
  const SparseField f = make(two_leaves(), 1, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(f.value({-1, 2, 3})));
  EXPECT_TRUE(std::isnan(f.value({1000, 1000, 1000})));
  EXPECT_TRUE(std::isnan(f.leaf(0)[0]));
}

TEST(SparseField, GridsHaveTheTopologyAndTheLattice) {
  const auto topology = two_leaves();
  const SparseField f = make(topology, 3, 0);
  ASSERT_EQ(f.grids().components.size(), 3u);
  for (const auto& grid : f.grids().components) {
    EXPECT_EQ(grid->activeVoxelCount(), topology->active_voxel_count());
    EXPECT_TRUE(grid->tree().isValueOn(grid_index({-1, 2, 3})));
    EXPECT_FALSE(grid->tree().isValueOn(grid_index({-2, 2, 3})));
    EXPECT_EQ(grid->indexToWorld(grid_index({0, 0, 0})), openvdb::Vec3d(1.25, 2.25, 3.25));
    EXPECT_EQ(grid->indexToWorld(grid_index({2, 4, -6})), openvdb::Vec3d(2.25, 4.25, 0.25));
    EXPECT_EQ(grid->getName(), "velocity");
  }
}

TEST(SparseField, GoesOverToAnotherUnitInDoublePrecision) {
  SparseField f = make(two_leaves(), 3, std::numeric_limits<float>::quiet_NaN());
  f.leaf(0, 2)[leaf_offset({-1, 2, 3})] = 7;
  f.change_units(0.3, "sqrt(g d)", Lattice(0.25, {0.5, 1, 1.5}));
  // In single precision both 0.3 and the quotient would be rounded.
  EXPECT_EQ(f.value({-1, 2, 3}, 2), static_cast<float>(7 / 0.3));
  EXPECT_NE(f.value({-1, 2, 3}, 2), 7 / 0.3F);
  EXPECT_TRUE(std::isnan(f.value({-4, 2, 3}, 2)));
  EXPECT_TRUE(std::isnan(f.value({0, 0, 0}, 1)));
  EXPECT_EQ(f.meta().unit, "sqrt(g d)");
  for (const auto& grid : f.grids().components)
    EXPECT_EQ(grid->indexToWorld(grid_index({2, 4, -6})), openvdb::Vec3d(1.125, 2.125, 0.125));
}

TEST(SparseField, RefusesUnitsThatWouldChangeItsBackground) {
  SparseField f = make(two_leaves(), 1, -2);
  EXPECT_THROW(f.change_units(2, "m", Lattice(1, {0, 0, 0})), std::invalid_argument);
}

TEST(SparseField, CanBeMoved) {
  SparseField f = make(two_leaves(), 1, 0);
  f.leaf(0)[leaf_offset({-1, 2, 3})] = 7;
  SparseField g = std::move(f);
  EXPECT_EQ(g.value({-1, 2, 3}), 7);
  EXPECT_EQ(g.leaf(0)[leaf_offset({-1, 2, 3})], 7);
}

TEST(SparseField, EmptyTopologyIsAllBackground) {
  const SparseField f = make(std::make_shared<const Topology>(), 1, -2);
  EXPECT_EQ(f.value({0, 0, 0}), -2);
  EXPECT_EQ(f.grids().components[0]->activeVoxelCount(), 0u);
}

}  // namespace
}  // namespace grainvdb::sparse_field_test
