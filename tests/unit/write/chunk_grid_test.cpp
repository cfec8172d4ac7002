#include "write/chunk_grid.hpp"

#include <gmock/gmock.h>

#include "unit/write/support.hpp"

namespace grainvdb::chunk_grid_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ChunkGrid, CutsEachAxisIntoEqualChunksOfAtMost32) {
  const ChunkGrid small({0, 0, 0}, {0, 31, 32});
  EXPECT_THAT(small.voxels(), ElementsAre(1, 32, 33));
  EXPECT_THAT(small.chunk(), ElementsAre(1, 32, 17));
  const ChunkGrid large({-100, -1, 5}, {-1, 63, 1004});
  EXPECT_THAT(large.voxels(), ElementsAre(100, 65, 1000));
  EXPECT_THAT(large.chunk(), ElementsAre(25, 22, 32));
}

TEST(ChunkGrid, TakesTheWholeRangeOfCoordinates) {
  const std::int32_t far = std::numeric_limits<std::int32_t>::max();
  const ChunkGrid grid({-far, 0, 0}, {far, 0, 0});
  EXPECT_EQ(grid.voxels()[0], 4294967295U);
  const auto topology = testing::make_topology({far - 1, 0, 0}, {far - 1, 0, 0}, [](const Coord&) { return true; });
  const auto chunks = grid.occupied(*topology);
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks[0].start[0], (4294967293U / grid.chunk()[0]) * grid.chunk()[0]);
}

TEST(ChunkGrid, RefusesAnEmptyBox) {
  EXPECT_THROW(ChunkGrid({0, 0, 0}, {0, -1, 0}), std::invalid_argument);
}

TEST(ChunkGrid, FindsTheChunksThatHoldActiveVoxels) {
  const ChunkGrid grid({-2, 0, 0}, {61, 31, 31});  // two chunks along x, the second from voxel 30
  ASSERT_THAT(grid.chunk(), ElementsAre(32, 32, 32));
  const auto across = testing::make_topology({24, 0, 0}, {31, 0, 0}, [](const Coord&) { return true; });
  const auto both = grid.occupied(*across);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_THAT(both[0].start, ElementsAre(0, 0, 0));
  EXPECT_THAT(both[1].start, ElementsAre(32, 0, 0));
  EXPECT_THAT(both[0].leaves, ElementsAre(0));
  EXPECT_THAT(both[1].leaves, ElementsAre(0));
  const auto left = testing::make_topology({24, 0, 0}, {31, 0, 0}, [](const Coord& c) { return c.x < 30; });
  EXPECT_EQ(grid.occupied(*left).size(), 1U);
  EXPECT_THAT(grid.occupied(Topology()), IsEmpty());
}

TEST(ChunkGrid, OrdersChunksAsTheFileDoes) {
  const ChunkGrid grid({0, 0, 0}, {63, 63, 63});
  const auto corners = testing::make_topology(
      {0, 0, 0}, {63, 63, 63}, [](const Coord& c) { return c.x % 63 == 0 && c.y % 63 == 0 && c.z % 63 == 0; });
  const auto chunks = grid.occupied(*corners);
  ASSERT_EQ(chunks.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_THAT(chunks[i].start, ElementsAre(32 * (i & 1), 32 * (i >> 1 & 1), 32 * (i >> 2)));
}

TEST(ChunkGrid, GathersOnlyActiveVoxelsOverTheBackground) {
  const Coord first{-3, 2, 5}, last{2, 4, 6};
  const ChunkGrid grid(first, last);
  const auto topology = testing::make_topology(first, last, [](const Coord& c) { return c.x != 0; });
  const Lattice lattice(1.0, {0, 0, 0});
  SparseField field(testing::meta_of("v", 3, -1.0F), topology, lattice);
  testing::fill(field, 0);
  const auto chunks = grid.occupied(*topology);
  ASSERT_EQ(chunks.size(), 1U);
  std::vector<float> out{99.0F};
  grid.gather(
      chunks[0], *topology, 3, -1.0F,
      [&](std::size_t leaf, std::size_t c) { return field.leaf(leaf, static_cast<int>(c)); }, out);
  ASSERT_EQ(out.size(), 6U * 3U * 2U * 3U);
  std::size_t i = 0;
  testing::for_each_voxel(first, last, [&](const Coord& c) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(out[i++], c.x != 0 ? testing::known_value(c, k, 0) : -1.0F);
  });
}

}  // namespace
}  // namespace grainvdb::chunk_grid_test
