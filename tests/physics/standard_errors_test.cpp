// Standard errors of fields against a jackknife that runs the whole pipeline on all frames but those of a block.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/error.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/memory_model.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::standard_errors_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string base_of(const std::string& error) {
  return error.substr(0, error.size() - std::string("_error").size());
}

/// Every standard error, with the fields that they are of.
Pipeline errors_of(const Scene& scene, std::size_t blocks) {
  std::vector<std::string> fields;
  for (const std::string& error : all_errors()) {
    fields.push_back(base_of(error));
    fields.push_back(error);
  }
  Pipeline p = scene.pipeline(std::move(fields));
  set_option(p, "kinetic_stress", "reference", std::string("time_mean_moments"));
  p.blocks = blocks;
  return p;
}

struct Block {
  std::size_t first, count;
};

std::vector<Frame> only(const std::vector<Frame>& frames, const Block& block) {
  const auto first = frames.begin() + static_cast<std::ptrdiff_t>(block.first);
  return {first, first + static_cast<std::ptrdiff_t>(block.count)};
}
std::vector<Frame> without(std::vector<Frame> frames, const Block& block) {
  const auto first = frames.begin() + static_cast<std::ptrdiff_t>(block.first);
  frames.erase(first, first + static_cast<std::ptrdiff_t>(block.count));
  return frames;
}

/// A field of some of the frames, and nothing else: its voxels are those that what it is made of reaches.
Written field_of(Pipeline p, const std::vector<Frame>& frames, const std::string& field) {
  p.fields = {field};
  p.window = p.window_step = 0;
  return run(p, frames).only();
}

/// One field left out block by block.
struct LeftOut {
  std::vector<Block> blocks;
  std::size_t frames = 0;
  std::vector<Written> without, alone;
};

LeftOut leave_out(const Pipeline& p, const std::vector<Frame>& frames, const std::vector<Block>& blocks,
                  const std::string& field) {
  LeftOut all{blocks, frames.size(), {}, {}};
  for (const Block& block : blocks) {
    all.without.push_back(field_of(p, without(frames, block), field));
    all.alone.push_back(field_of(p, only(frames, block), field));
  }
  return all;
}

/// By pseudo-values (Busing et al. 1999), with the largest magnitude among the fields that enter.
std::pair<double, double> jackknife(const LeftOut& all, const FieldCopy& whole, const Coord& at, int component) {
  const double value = static_cast<double>(whole.at(at, component));
  const auto n = static_cast<double>(all.frames);
  const auto count = static_cast<double>(all.blocks.size());
  double mean = count * value;
  double largest = std::abs(value);
  std::vector<double> h, pseudo;
  for (std::size_t j = 0; j < all.blocks.size(); ++j) {
    const auto m = static_cast<double>(all.blocks[j].count);
    const double rest = static_cast<double>(all.without[j].field(whole.meta.name).at(at, component));
    largest = std::max(largest, std::abs(rest));
    h.push_back(n / m);
    pseudo.push_back(n / m * value - (n / m - 1) * rest);
    mean -= (1 - m / n) * rest;
  }
  double variance = 0;
  for (std::size_t j = 0; j < h.size(); ++j) variance += (pseudo[j] - mean) * (pseudo[j] - mean) / (h[j] - 1) / count;
  return {std::sqrt(variance), largest};
}

std::size_t blocks_that_reach(const LeftOut& all, const std::string& field, const Coord& at) {
  return static_cast<std::size_t>(std::count_if(all.alone.begin(), all.alone.end(),
                                                [&](const Written& block) { return block.field(field).active(at); }));
}

struct Count {
  std::size_t defined = 0, undefined = 0, clear = 0;
};

/// `rounding` is that of the fields that are left out, relative; their differences are weighted by √(h - 1) at most.
Count expect_errors(const Written& found, const LeftOut& all, const std::string& field, double rounding) {
  const FieldCopy& whole = found.field(field);
  const FieldCopy& error = found.field(field + "_error");
  EXPECT_EQ(error.meta.unit, whole.meta.unit);
  EXPECT_TRUE(std::isnan(error.meta.background));
  Count n;
  whole.for_each_active([&](const Coord& at) {
    for (int c = 0; c < whole.meta.components; ++c) {
      const float e = error.at(at, c);
      const auto [expected, largest] = jackknife(all, whole, at, c);
      if (std::isnan(whole.at(at, c))) {
        EXPECT_TRUE(std::isnan(e)) << field;
        ++n.undefined;
      } else if (std::isnan(expected) || blocks_that_reach(all, field, at) < 2) {
        EXPECT_TRUE(std::isnan(e)) << field;
        EXPECT_TRUE(found.mask_at(at) & static_cast<std::uint32_t>(Reason::few_blocks)) << field;
        ++n.undefined;
      } else {
        const double weight = std::sqrt(static_cast<double>(all.frames));
        const double bound = 0x1p-23 * expected + weight * rounding * largest;
        EXPECT_NEAR(e, expected, bound) << field << ' ' << c;
        ++n.defined;
        if (expected > 100 * bound) ++n.clear;
      }
    }
  });
  return n;
}

std::vector<std::string> bases() {
  std::vector<std::string> fields;
  for (const std::string& error : all_errors()) fields.push_back(base_of(error));
  return fields;
}

// In blocks of one frame all sums are added up in the order of the run that lacks the frame: what is left out has the
// same bytes, and only the formula rounds, in double.
void expect_exact(const Scene& scene) {
  const std::size_t n = scene.frames.size();
  const Pipeline p = errors_of(scene, n);
  const Result r = run(p, scene.frames);
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < n; ++k) blocks.push_back({k, 1});
  for (const std::string& field : bases()) {
    const LeftOut all = leave_out(p, scene.frames, blocks, field);
    const Count count = expect_errors(r.only(), all, field, 1e-13);
    EXPECT_GT(count.clear, 20U) << field;
    EXPECT_GT(count.defined, 50U) << field;
  }
}

TEST(StandardErrors, AreThoseOfRunsWithoutEachFrame) {
  expect_exact(moving(walled_scene(), 4));
}

// Grains that move on from voxel to voxel: many are reached by one frame alone.
TEST(StandardErrors, AreUndefinedWhereOneBlockAloneReaches) {
  const Scene scene = moving(dilute_scene(), 5);
  expect_exact(scene);
  const Result r = run(errors_of(scene, 5), scene.frames);
  std::size_t few = 0;
  r.only().field("phi").for_each_active([&](const Coord& at) {
    const bool lone = (r.only().mask_at(at) & static_cast<std::uint32_t>(Reason::few_blocks)) != 0;
    few += lone && std::isnan(r.only().field("phi_error").at(at)) ? 1U : 0U;
  });
  EXPECT_GT(few, 20U);
}

// Longer blocks, of unequal length: sums are added up in another order, which reaches the floats as a unit of their
// last place, and more where they are differences of sums.
TEST(StandardErrors, OfBlocksOfUnequalLength) {
  const Scene scene = moving(dilute_scene(), 7);
  const std::vector<std::string> fields{"phi", "velocity", "temperature", "contact_stress"};
  Pipeline p = errors_of(scene, 3);
  const Result r = run(p, scene.frames);
  for (const std::string& field : fields) {
    const LeftOut all = leave_out(p, scene.frames, {{0, 2}, {2, 2}, {4, 3}}, field);
    EXPECT_GT(expect_errors(r.only(), all, field, 0x1p-22).clear, 50U) << field;
  }
  EXPECT_THAT(r.report.averaging,
              ElementsAre("1 output time of 7 frames", "standard errors from 3 blocks of frames for each output time"));
}

// Each window has the errors that a run over its frames alone gives; the last one has fewer blocks, or none.
TEST(StandardErrors, OfWindowsThatSlide) {
  const Scene scene = moving(dilute_scene(), 9);
  Pipeline p = scene.pipeline({"phi", "phi_error", "velocity", "velocity_error"});
  p.blocks = 4;
  p.window = 4;
  p.window_step = 2;
  const auto frames = [&](std::size_t first, std::size_t count) { return only(scene.frames, {first, count}); };
  const Result r = run(p, scene.frames);
  ASSERT_EQ(r.record.times.size(), 4U);
  EXPECT_THAT(r.report.averaging.at(1), "standard errors from 4 blocks of frames for each output time, 3 for the last");
  for (std::size_t w = 0; w < 4; ++w) {
    std::vector<Block> blocks;
    for (std::size_t k = 0; k < (w < 3 ? 4U : 3U); ++k) blocks.push_back({k, 1});
    for (const char* field : {"phi", "velocity"}) {
      const LeftOut all = leave_out(p, frames(2 * w, blocks.size()), blocks, field);
      EXPECT_GT(expect_errors(r.record.times[w], all, field, 1e-13).clear, 50U) << w << field;
    }
  }

  p.window_step = 0;
  const Result last_alone = run(p, scene.frames);
  ASSERT_EQ(last_alone.record.times.size(), 3U);
  EXPECT_THAT(last_alone.report.averaging.at(1), HasSubstr("none for the last"));
  const Written& last = last_alone.record.times.back();
  last.field("phi").for_each_active([&](const Coord& at) {
    EXPECT_TRUE(std::isnan(last.field("phi_error").at(at)));
    EXPECT_TRUE(last.mask_at(at) & static_cast<std::uint32_t>(Reason::few_blocks));
  });
}

// In two sweeps the kinetic stress without a block is still about the mean velocity of all frames. Where each block
// has that mean, here zero, as each frame comes with the one of opposite velocities, it is what a run without the block
// gives; velocities that should cancel do so to 1e-5 of their magnitudes, stresses to twice that.
TEST(StandardErrors, OfTheKineticStressInTwoSweeps) {
  const Scene moved = moving(dilute_scene(), 4);
  std::vector<Frame> frames;
  for (const Frame& frame : moved.frames) {
    frames.push_back(frame);
    frames.push_back(frame);
    for (auto& column : frames.back().particles.velocity)
      for (double& v : column) v = -v;
    for (Frame* f : {&frames[frames.size() - 2], &frames.back()})
      f->step = static_cast<std::int64_t>(frames.size()) * 10 + (f == &frames.back() ? 5 : 0);
  }
  Pipeline p = moved.pipeline({"kinetic_stress", "kinetic_stress_error"});
  p.blocks = 4;
  ASSERT_EQ(make_plan(p).sweeps.size(), 2U);
  const LeftOut all = leave_out(p, frames, {{0, 2}, {2, 2}, {4, 2}, {6, 2}}, "kinetic_stress");
  EXPECT_GT(expect_errors(run(p, frames).only(), all, "kinetic_stress", 2e-5).clear, 50U);
}

TEST(StandardErrors, HaveTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = moving(dilute_scene(), 6);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return run(errors_of(scene, 3), scene.frames);
  };
  const Result one = with(1);
  const Result four = with(4);
  for (const auto& [name, field] : one.only().fields) {
    const FieldCopy& other = four.only().field(name);
    EXPECT_TRUE(std::equal(field.values.begin(), field.values.end(), other.values.begin(), other.values.end(),
                           [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }))
        << name;
  }
}

TEST(StandardErrors, CostNothingWhereTheyAreNotWanted) {
  const Scene scene = moving(dilute_scene(), 4);
  Pipeline p = scene.pipeline({"phi", "velocity"});
  p.blocks = 1000;  // more than there are frames
  const Result r = run(p, scene.frames);
  EXPECT_TRUE(r.plan.errors.by_block.empty());
  EXPECT_TRUE(r.plan.block_sums.empty());
  EXPECT_EQ(r.report.grids, 4U);
  EXPECT_THAT(r.report.averaging, ElementsAre("1 output time of 4 frames"));
  EXPECT_THAT(describe(r.plan, p), Not(HasSubstr("block")));
}

// Only what the errors that are wanted derive is summed by blocks.
TEST(StandardErrors, SumByBlocksOnlyWhatTheyNeed) {
  const Scene scene = moving(dilute_scene(), 4);
  Pipeline p = scene.pipeline({"phi_error", "stress"});
  p.blocks = 4;
  const Plan plan = make_plan(p);
  ASSERT_EQ(plan.block_sums.size(), 1U);
  EXPECT_EQ(plan.block_sums[0]->channels, 1);
  ASSERT_EQ(plan.errors.by_block.size(), 1U);
  EXPECT_EQ(plan.errors.by_block[0]->name, "phi");
  // The field itself is derived, but not written.
  const Result r = run(p, scene.frames);
  EXPECT_EQ(r.only().fields.size(), 2U);
  EXPECT_TRUE(r.only().fields.contains("phi_error"));
  EXPECT_TRUE(r.only().has_mask);
}

TEST(StandardErrors, WantAsManyFramesAsBlocks) {
  const Scene scene = moving(dilute_scene(), 4);
  Pipeline p = scene.pipeline({"phi_error"});
  p.blocks = 5;
  try {
    run(p, scene.frames);
    FAIL() << "not refused";
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("4 frames"));
    EXPECT_THAT(e.what(), HasSubstr("average.blocks = 5"));
  }
  p.blocks = 2;
  p.window = 1;
  EXPECT_THROW(run(p, scene.frames), ConfigError);
  p.window = 2;
  EXPECT_EQ(run(p, scene.frames).record.times.size(), 2U);
}

// Sums by blocks are bounded as all sums are, and graph says what they take.
TEST(StandardErrors, KeepWithinTheMemoryThatIsAllowed) {
  const Scene scene = moving(dilute_scene(), 6);
  Pipeline p = scene.pipeline({"velocity", "velocity_error"});
  p.blocks = 6;
  const auto leaves = static_cast<double>(run(p, scene.frames).only().field("velocity").topology->leaf_count());
  const double sums = leaves * 512 * 8 * 4;  // four channels
  p.limits.memory_gb = 8 * sums / 1e9;       // of the window and six blocks, and the mean without one: too many
  EXPECT_THROW(run(p, scene.frames), LimitError);
  p.fields = {"velocity"};
  run(p, scene.frames);
  // 4 channels and the frames of 6 blocks, 4 channels of the mean without one, 3 sums of 3 components; 3 components
  // without a block and 3 of errors. Leaves have masks and places besides, and the memory has holes.
  const double without = memory_model(make_plan(p), p).per_voxel;
  p.fields = {"velocity", "velocity_error"};
  const double more = memory_model(make_plan(p), p).per_voxel - without;
  const double least = 8 * (5 * 6 + 4 + 3 * 3) + 4.25 * (3 + 3);
  EXPECT_GT(more, least);
  EXPECT_LT(more, 1.2 * least);
}

}  // namespace
}  // namespace grainvdb::testing::standard_errors_test
