#include "average/moment_sums.hpp"

#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "unit/average/support.hpp"

namespace grainvdb::moment_sums_test {
namespace {

MomentMeans finish(MomentSums& sums, std::size_t frames) {
  sums.end_sweep(frames);
  return sums.means();
}

TEST(MomentSums, MeanOverTheUnionOfTheVoxels) {
  const MomentPtr m = moment("m");
  MomentSums sums({m});
  sums.add(m, buffers({a, b}, {3}), 0);
  sums.end_frame();
  sums.add(m, buffers({b, far_away}, {5}), 0);
  sums.end_frame();
  const MomentMeans means = finish(sums, 2);

  EXPECT_EQ(means.topology()->active_voxel_count(), 3U);
  EXPECT_EQ(value_at(means, a, *m), 1.5);  // 0 in the second frame
  EXPECT_EQ(value_at(means, b, *m), 4);
  EXPECT_EQ(value_at(means, far_away, *m), 2.5);
  EXPECT_EQ(frames_at(means, a), 1);
  EXPECT_EQ(frames_at(means, b), 2);
  EXPECT_EQ(frames_at(means, far_away), 1);
  // Voxels of a stored leaf that nothing reached.
  EXPECT_EQ(value_at(means, {7, 7, 7}, *m), 0);
  EXPECT_EQ(frames_at(means, {7, 7, 7}), 0);
}

// Two moments of a frame may reach different voxels, as particles and contacts do: one sample all the same.
TEST(MomentSums, AFrameIsOneSampleWhateverReachesTheVoxel) {
  const MomentPtr particles = moment("particles");
  const MomentPtr contacts = moment("contacts");
  MomentSums sums({particles, contacts});
  sums.add(particles, buffers({a, b}, {1}), 0);
  sums.add(contacts, buffers({b, far_away}, {1}), 0);
  sums.end_frame();
  const MomentMeans means = finish(sums, 1);
  EXPECT_EQ(means.topology()->active_voxel_count(), 3U);
  for (const Coord& c : {a, b, far_away}) EXPECT_EQ(frames_at(means, c), 1);
  EXPECT_EQ(value_at(means, far_away, *particles), 0);
  EXPECT_EQ(value_at(means, far_away, *contacts), 1);
}

TEST(MomentSums, FramesWithoutMaterialCountInTheMean) {
  const MomentPtr m = moment("m");
  MomentSums sums({m});
  sums.add(m, buffers({a}, {4}), 0);
  sums.end_frame();
  for (int k = 0; k < 3; ++k) {
    sums.add(m, buffers({}, {0}), 0);
    sums.end_frame();
  }
  const MomentMeans means = finish(sums, 4);
  EXPECT_EQ(value_at(means, a, *m), 1);
  EXPECT_EQ(frames_at(means, a), 1);
}

TEST(MomentSums, ChannelsOfSeveralMoments) {
  const MomentPtr scalar = moment("scalar");
  const MomentPtr vector = moment("vector", 3);
  MomentSums sums({scalar, vector});
  // As one splat gives them, in another order: three channels of the vector, then something else, then the scalar.
  const LeafBuffers part = buffers({b}, {10, 20, 30, 99, 1});
  sums.add(vector, part, 0);
  sums.add(scalar, part, 4);
  sums.end_frame();
  const MomentMeans means = finish(sums, 1);
  EXPECT_EQ(value_at(means, b, *scalar), 1);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(value_at(means, b, *vector, c), 10 * (c + 1));
  EXPECT_THROW(means.first_channel(*moment("other")), std::out_of_range);
}

// Moments are told apart by their names, so two descriptions of one are summed and kept once.
TEST(MomentSums, EqualNamesAreOneMoment) {
  MomentSums sums({moment("m", 2), moment("m", 2)});
  const MomentPtr m = moment("m", 2);
  EXPECT_TRUE(sums.wants(*m));
  EXPECT_FALSE(sums.wants(*moment("other")));
  sums.add(m, buffers({a}, {1, 2}), 0);
  sums.end_frame();
  const MomentMeans means = finish(sums, 1);
  EXPECT_EQ(value_at(means, a, *m, 1), 2);
}

// A second sweep splats the first one's moments again to get at the frame's velocity; they must not count twice.
TEST(MomentSums, TwoSweepsCountOnce) {
  const MomentPtr first = moment("first");
  const MomentPtr second = moment("second");
  MomentSums sums({first, second});
  for (int frame = 0; frame < 2; ++frame) {
    EXPECT_TRUE(sums.wants(*first));
    sums.add(first, buffers({a}, {1}), 0);
    sums.end_frame();
  }
  sums.end_sweep(2);
  EXPECT_FALSE(sums.wants(*first));
  EXPECT_EQ(value_at(sums.means(), a, *first), 1);
  EXPECT_THROW(sums.means().first_channel(*second), std::out_of_range) << "not complete yet";
  for (int frame = 0; frame < 2; ++frame) {
    EXPECT_TRUE(sums.wants(*second));
    sums.add(second, buffers({a}, {10}), 0);
    sums.end_frame();
  }
  sums.end_sweep(2);
  EXPECT_FALSE(sums.wants(*second));
  const MomentMeans means = sums.means();
  EXPECT_EQ(value_at(means, a, *first), 1);
  EXPECT_EQ(value_at(means, a, *second), 10);
  EXPECT_EQ(frames_at(means, a), 2);
}

// Floating-point sums depend on their order: here only that of the frames gives 0 and not 1.
TEST(MomentSums, TermsAreAddedInTheOrderOfTheFrames) {
  const MomentPtr m = moment("m");
  MomentSums sums({m});
  for (double x : {1.0, 1e16, -1e16}) {
    sums.add(m, buffers({a}, {x}), 0);
    sums.end_frame();
  }
  EXPECT_EQ(value_at(finish(sums, 1), a, *m), 0);
}

TEST(MomentSums, SameBytesForAnyNumberOfThreads) {
  const MomentPtr m = moment("m", 2);
  std::vector<Coord> voxels;
  for (int i = -20; i < 20; ++i)
    for (int j = -20; j < 20; ++j) voxels.push_back({8 * i, 8 * j, i * j % 5});
  std::vector<std::vector<double>> results;
  for (std::size_t threads : {1U, 2U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    MomentSums sums({m});
    for (int frame = 1; frame <= 5; ++frame) {
      sums.add(m, buffers(voxels, {0.1 * frame, 1.0 / frame}), 0);
      sums.end_frame();
    }
    const MomentMeans means = finish(sums, 5);
    std::vector<double>& all = results.emplace_back();
    for (std::size_t l = 0; l < means.topology()->leaf_count(); ++l)
      for (int c = 0; c < 2; ++c) all.insert(all.end(), means.block(l, *m, c), means.block(l, *m, c) + leaf_size);
  }
  ASSERT_EQ(results[0].size(), results[1].size());
  EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(double)), 0);
}

TEST(MomentSums, LeavesAndBytes) {
  const MomentPtr m = moment("m", 3);
  MomentSums sums({m});
  EXPECT_EQ(sums.leaf_count(), 0U);
  sums.add(m, buffers({a, b, far_away}, {1, 2, 3}), 0);
  EXPECT_EQ(sums.leaf_count(), 2U);  // a and b share one
  EXPECT_GE(sums.bytes(10), 10 * 3 * leaf_size * sizeof(double));
  EXPECT_EQ(sums.bytes(20), 2 * sums.bytes(10));
}

TEST(MomentSums, NothingAtAll) {
  const MomentPtr m = moment("m");
  MomentSums sums({m});
  sums.end_frame();
  const MomentMeans means = finish(sums, 1);
  EXPECT_EQ(means.topology()->leaf_count(), 0U);
}

TEST(MomentSums, UnknownMomentsAreRefused) {
  MomentSums sums({moment("m")});
  EXPECT_THROW(sums.add(moment("other"), buffers({a}, {1}), 0), std::out_of_range);
}

}  // namespace
}  // namespace grainvdb::moment_sums_test
