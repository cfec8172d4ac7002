#include "grainvdb/topology.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/mask.hpp"

namespace grainvdb::topology_test {
namespace {

LeafMask mask_of(const std::vector<int>& offsets) {
  LeafMask mask;
  for (int o : offsets) mask.set(o);
  return mask;
}

TEST(Leaf, OriginsAndOffsetsOfNegativeVoxels) {
  EXPECT_EQ(leaf_origin({-1, 7, 8}), (Coord{-8, 0, 8}));
  EXPECT_EQ(leaf_offset({-1, 7, 8}), 7 * 64 + 7 * 8 + 0);
  for (const Coord c : {Coord{-9, -8, -1}, Coord{0, 1, 2}, Coord{100, -100, 15}})
    EXPECT_EQ(voxel_at(leaf_origin(c), leaf_offset(c)), c);
}

TEST(LeafMask, SetsTestsCountsAndVisits) {
  const std::vector<int> offsets{0, 63, 64, 200, 511};
  LeafMask mask = mask_of(offsets);
  EXPECT_EQ(mask.count(), 5u);
  EXPECT_FALSE(mask.none());
  EXPECT_TRUE(mask.test(63));
  EXPECT_FALSE(mask.test(62));
  std::vector<int> visited;
  mask.for_each([&](int o) { visited.push_back(o); });
  EXPECT_EQ(visited, offsets);
  mask |= mask_of({1, 511});
  EXPECT_EQ(mask.count(), 6u);
  EXPECT_TRUE(LeafMask{}.none());
}

TEST(Topology, SortsMergesAndDropsLeaves) {
  const Topology t({{8, 0, 0}, {-8, 0, 0}, {0, 0, 0}, {8, 0, 0}},
                   {mask_of({1}), mask_of({2, 3}), LeafMask{}, mask_of({1, 4})});
  ASSERT_EQ(t.leaf_count(), 2u);
  EXPECT_EQ(t.origin(0), (Coord{-8, 0, 0}));
  EXPECT_EQ(t.origin(1), (Coord{8, 0, 0}));
  EXPECT_EQ(t.mask(1), mask_of({1, 4}));
  EXPECT_EQ(t.active_voxel_count(), 4u);
  EXPECT_EQ(t.find({8, 0, 0}), 1u);
  EXPECT_FALSE(t.find({0, 0, 0}));
  EXPECT_FALSE(t.find({16, 0, 0}));
}

TEST(Topology, BoundsAreThoseOfActiveVoxels) {
  const Topology t({{-8, 0, 0}, {8, 8, 0}}, {mask_of({leaf_offset({-3, 2, 5})}), mask_of({leaf_offset({9, 12, 1})})});
  const auto bounds = t.bounds();
  ASSERT_TRUE(bounds);
  EXPECT_EQ(bounds->first, (Coord{-3, 2, 1}));
  EXPECT_EQ(bounds->last, (Coord{9, 12, 5}));
  EXPECT_FALSE(Topology{}.bounds());
  EXPECT_EQ(Topology{}.active_voxel_count(), 0u);
}

TEST(Topology, NeedsAMaskPerLeaf) {
  EXPECT_THROW(Topology({{0, 0, 0}}, {}), std::invalid_argument);
}

TEST(LeafBuffers, AreZeroAndSeparateByLeafAndChannel) {
  const auto t = std::make_shared<const Topology>(std::vector<Coord>{{0, 0, 0}, {8, 0, 0}},
                                                  std::vector<LeafMask>{mask_of({0}), mask_of({0})});
  LeafBuffers b(t, 3);
  EXPECT_EQ(b.bytes(), 2u * 3 * 512 * sizeof(double));
  b.block(1, 2)[511] = 4;
  double sum = 0;
  for (std::size_t l = 0; l < 2; ++l)
    for (int c = 0; c < 3; ++c)
      for (int o = 0; o < leaf_size; ++o) sum += b.block(l, c)[o];
  EXPECT_EQ(sum, 4);
}

TEST(Mask, CountsActiveVoxelsThatCarryAReason) {
  const auto t =
      std::make_shared<const Topology>(std::vector<Coord>{{0, 0, 0}}, std::vector<LeafMask>{mask_of({3, 4, 5})});
  Mask mask(t);
  mask.add(0, 3, Reason::low_pressure);
  mask.add(0, 3, Reason::no_fluctuation);
  mask.add(0, 5, Reason::low_pressure);
  mask.add(0, 6, Reason::low_pressure);  // not active
  EXPECT_EQ(mask.count(Reason::low_pressure), 2u);
  EXPECT_EQ(mask.count(Reason::no_fluctuation), 1u);
  EXPECT_EQ(mask.count(Reason::outside), 0u);
}

TEST(Mask, ReasonsAreDistinctBitsInOrder) {
  std::uint32_t previous = 0;
  for (const ReasonInfo& r : reasons()) {
    const auto bit = static_cast<std::uint32_t>(r.reason);
    EXPECT_EQ(std::popcount(bit), 1);
    EXPECT_GT(bit, previous);
    EXPECT_FALSE(r.name.empty());
    EXPECT_FALSE(r.meaning.empty());
    previous = bit;
  }
}

}  // namespace
}  // namespace grainvdb::topology_test
