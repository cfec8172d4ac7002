#include "average/window_sums.hpp"

#include <gtest/gtest.h>

#include "average/leave_one_out.hpp"
#include "unit/average/support.hpp"

namespace grainvdb::window_sums_test {
namespace {

const MomentPtr plain = moment("plain");
const MomentPtr vector = moment("vector", 2);

/// A frame that gives `vector` (x, 10 x) and `plain` -x at the voxels.
void add_frame(WindowSums& sums, double x, const std::vector<Coord>& voxels = {a, far_away}) {
  const LeafBuffers part = buffers(voxels, {-x, x, 10 * x});
  if (sums.wants(*vector)) sums.add(vector, part, 1);
  if (sums.wants(*plain)) sums.add(plain, part, 0);
  sums.end_frame();
}

/// Blocks of two, one and one frames.
WindowSums in_blocks() {
  WindowSums sums({plain, vector}, {vector});
  sums.begin_block(0);
  add_frame(sums, 1);
  add_frame(sums, 2);
  sums.begin_block(1);
  add_frame(sums, 4);
  sums.begin_block(2);
  add_frame(sums, 8, {a, b});
  return sums;
}

TEST(WindowSums, BlocksChangeNothingOfTheMeans) {
  WindowSums blocked = in_blocks();
  WindowSums sums({plain, vector}, {});
  for (const double x : {1.0, 2.0, 4.0}) {
    sums.begin_block(0);
    add_frame(sums, x);
  }
  add_frame(sums, 8, {a, b});
  EXPECT_TRUE(sums.blocks().empty());
  for (WindowSums* s : {&blocked, &sums}) {
    s->end_sweep();
    const MomentMeans means = s->means();
    EXPECT_EQ(value_at(means, a, *vector, 1), 150.0 / 4);
    EXPECT_EQ(value_at(means, far_away, *vector), 7.0 / 4);
    EXPECT_EQ(value_at(means, b, *plain), -2);
    EXPECT_EQ(frames_at(means, far_away), 3);
    EXPECT_EQ(frames_at(means, a), 4);
  }
}

TEST(WindowSums, MeansWithoutABlock) {
  WindowSums sums = in_blocks();
  sums.end_sweep();
  const MomentMeans whole = sums.means();
  LeaveOneOut others(sums, whole);
  ASSERT_EQ(others.block_count(), 3U);
  EXPECT_EQ(others.frames(), 4U);
  EXPECT_EQ(others.frames(0), 2U);
  struct Expected {
    double at_a, at_b, at_far;
  };
  const Expected expected[] = {{12.0 / 2, 8.0 / 2, 4.0 / 2}, {11.0 / 3, 8.0 / 3, 3.0 / 3}, {7.0 / 3, 0, 7.0 / 3}};
  for (std::size_t block = 0; block < 3; ++block) {
    const MomentMeans means = others.without(block);
    EXPECT_EQ(means.topology(), whole.topology());
    EXPECT_EQ(value_at(means, a, *vector), expected[block].at_a);
    EXPECT_DOUBLE_EQ(value_at(means, a, *vector, 1), 10 * expected[block].at_a);
    EXPECT_EQ(value_at(means, b, *vector), expected[block].at_b);
    EXPECT_EQ(value_at(means, far_away, *vector), expected[block].at_far);
    EXPECT_THROW(means.first_channel(*plain), std::out_of_range);
  }
  EXPECT_EQ(value_at(others.of_all(), a, *vector), 15.0 / 4);
}

TEST(WindowSums, VoxelsThatTwoBlocksReach) {
  WindowSums sums = in_blocks();
  sums.end_sweep();
  const MomentMeans whole = sums.means();
  const LeaveOneOut others(sums, whole);
  const auto twice = [&](const Coord& c) {
    return others.reached_twice(whole.topology()->find(leaf_origin(c)).value(), {vector}).test(leaf_offset(c));
  };
  EXPECT_TRUE(twice(a));
  EXPECT_TRUE(twice(far_away));
  EXPECT_FALSE(twice(b));
}

// A second sweep goes through the blocks again; its moments join those of the first.
TEST(WindowSums, BlocksOfTwoSweeps) {
  const MomentPtr second = moment("second");
  WindowSums sums({plain, vector, second}, {vector, second});
  for (std::size_t block : {0, 1}) {
    sums.begin_block(block);
    add_frame(sums, 1 + static_cast<double>(block));
  }
  sums.end_sweep();
  for (std::size_t block : {0, 1}) {
    sums.begin_block(block);
    EXPECT_FALSE(sums.wants(*vector));
    sums.add(second, buffers({a}, {100.0 * (1 + static_cast<double>(block))}), 0);
    sums.end_frame();
  }
  sums.end_sweep();
  const MomentMeans whole = sums.means();
  EXPECT_EQ(value_at(whole, a, *second), 150);
  EXPECT_EQ(frames_at(whole, a), 2);
  LeaveOneOut others(sums, whole);
  EXPECT_EQ(others.frames(), 2U);
  EXPECT_EQ(value_at(others.without(0), a, *second), 200);
  EXPECT_EQ(value_at(others.without(1), a, *vector), 1);
}

// Blocks of moments of the second sweep alone have the frames that they had in the first.
TEST(WindowSums, BlocksOfTheSecondSweepOnly) {
  const MomentPtr second = moment("second");
  WindowSums sums({plain, second}, {second});
  for (const bool again : {false, true}) {
    for (const std::size_t block : {0, 1}) {
      sums.begin_block(block);
      sums.add(again ? second : plain, buffers({a}, {4}), 0);
      sums.end_frame();
    }
    sums.end_sweep();
  }
  const MomentMeans whole = sums.means();
  LeaveOneOut others(sums, whole);
  EXPECT_EQ(others.frames(), 2U);
  EXPECT_EQ(value_at(others.without(0), a, *second), 4);
  EXPECT_EQ(frames_at(whole, a), 2);
}

// Frames summed elsewhere give what they give one by one.
TEST(WindowSums, PartsOfAWindow) {
  std::vector<WindowSums> parts;
  for (const double x : {1.0, 2.0, 4.0}) {
    parts.emplace_back(std::vector{plain, vector}, std::vector<MomentPtr>{});
    add_frame(parts.back(), x);
  }
  add_frame(parts.back(), 8, {a, b});
  WindowSums sums({plain, vector}, {vector});
  for (std::size_t k = 0; k < parts.size(); ++k) {
    sums.begin_block(k / 2);
    sums.add(parts[k]);
  }
  sums.end_sweep();
  const MomentMeans whole = sums.means();
  EXPECT_EQ(value_at(whole, a, *vector), 15.0 / 4);
  EXPECT_EQ(value_at(whole, b, *plain), -2);
  EXPECT_EQ(frames_at(whole, far_away), 3);
  LeaveOneOut others(sums, whole);
  ASSERT_EQ(others.block_count(), 2U);
  EXPECT_EQ(others.frames(0), 2U);
  EXPECT_EQ(value_at(others.without(0), a, *vector), 6);
  EXPECT_EQ(value_at(others.without(1), b, *vector), 0);
}

TEST(WindowSums, JoinedBlocks) {
  WindowSums sums = in_blocks();
  sums.join_blocks();
  ASSERT_EQ(sums.blocks().size(), 2U);
  sums.begin_block(2);
  add_frame(sums, 16);
  sums.end_sweep();
  const MomentMeans whole = sums.means();
  LeaveOneOut others(sums, whole);
  EXPECT_EQ(others.frames(0), 3U);
  EXPECT_EQ(others.frames(1), 1U);
  EXPECT_EQ(value_at(others.without(0), a, *vector), 12);
  EXPECT_EQ(value_at(others.without(1), a, *vector), 23.0 / 4);
}

TEST(WindowSums, BytesPerLeaf) {
  const std::size_t without = WindowSums::bytes_per_leaf({plain, vector}, {}, 8);
  EXPECT_GE(without, 3 * leaf_size * sizeof(double));
  EXPECT_GE(WindowSums::bytes_per_leaf({plain, vector}, {vector}, 8), without + 8 * 2 * leaf_size * sizeof(double));
}

}  // namespace
}  // namespace grainvdb::window_sums_test
