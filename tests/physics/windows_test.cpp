// Output times: windows of frames, and the frames that are selected.
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "support/compare.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::windows_test {
namespace {

const std::vector<std::string> fields{
    "phi",           "velocity", "temperature", "rotational_fluctuation", "contact_stress", "kinetic_stress",
    "mean_diameter", "frames"};

/// Every sum of one output time against the brute force over its frames.
void expect_mean_over(const Written& w, const std::vector<Frame>& frames, const Pipeline& pipeline) {
  const Reference reference = coarse_grain(frames, pipeline);
  std::vector<bool> active;
  for (int n : reference.any_frames) active.push_back(n > 0);
  EXPECT_EQ(topology_differences(*w.field("phi").topology, reference.box, active), 0U);
  for (const std::string& name : fields) {
    if (name == "frames") continue;
    const ReferenceField& f = reference.fields.at(name);
    const Agreement a = compare(
        w.field(name), reference.box, active, [&](std::size_t n, int c) { return f.expected(n, c); },
        [&](std::size_t n, int c) { return f.magnitude[f.index(n, c)]; });
    EXPECT_EQ(a.failures, 0U) << name << ": " << a.first_failure;
  }
  for (std::size_t n = 0; n < reference.box.size(); ++n)
    if (active[n]) {
      ASSERT_EQ(w.field("frames").at(reference.box.coord(n)), static_cast<float>(reference.any_frames[n]));
    }
}

TEST(Windows, EachFrameByItself) {
  const Scene scene = dilute_scene();
  Pipeline p = scene.pipeline(fields);
  p.window = 1;
  const Result r = run(p, scene.frames);
  ASSERT_EQ(r.record.times.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    SCOPED_TRACE(k);
    EXPECT_EQ(r.record.times[k].time.first_step, scene.frames[k].step);
    EXPECT_EQ(r.record.times[k].time.last_step, scene.frames[k].step);
    EXPECT_EQ(r.record.times[k].time.frame_count, 1U);
    EXPECT_EQ(r.record.times[k].time.time, static_cast<double>(scene.frames[k].step));
    expect_mean_over(r.record.times[k], {scene.frames[k]}, p);
  }
}

// The second sweep of a window must measure from that window's mean, and the last window holds what is left.
TEST(Windows, TwoFramesEach) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline(fields);
  p.window = 2;
  const Result r = run(p, scene.frames);
  ASSERT_EQ(r.record.times.size(), 2U);
  EXPECT_EQ(r.record.times[0].time.time, 175);
  EXPECT_EQ(r.record.times[0].time.frame_count, 2U);
  EXPECT_EQ(r.record.times[1].time.frame_count, 1U);
  expect_mean_over(r.record.times[0], {scene.frames[0], scene.frames[1]}, p);
  expect_mean_over(r.record.times[1], {scene.frames[2]}, p);
}

TEST(Windows, SelectedFramesOnly) {
  const Scene scene = dilute_scene();
  Pipeline p = scene.pipeline(fields);
  p.frames = {0, std::nullopt, 2};
  const Result r = run(p, scene.frames);
  EXPECT_EQ(r.only().time.frame_count, 2U);
  expect_mean_over(r.only(), {scene.frames[0], scene.frames[2]}, p);
}

// All output times of a series are written on one box of voxels, which holds every active voxel.
TEST(Windows, SeriesHasOneBox) {
  const Scene scene = walled_scene();
  Pipeline p = scene.pipeline(fields);
  p.window = 1;
  const Result r = run(p, scene.frames);
  ASSERT_EQ(r.record.layouts.size(), 1U);
  const OutputLayout& layout = r.record.layouts[0];
  EXPECT_EQ(layout.time_count, 3U);
  for (const Written& w : r.record.times) {
    const auto bounds = w.field("phi").topology->bounds().value();
    for (int a = 0; a < 3; ++a) {
      EXPECT_LE(layout.first[a], bounds.first[a]);
      EXPECT_GE(layout.last[a], bounds.last[a]);
    }
  }
  EXPECT_TRUE(r.record.committed);
}

// Grains leave an open box between two updates of its bounds: the box of a series has room for them.
TEST(Windows, SeriesHasRoomForGrainsJustOutsideAnOpenBox) {
  Scene scene = walled_scene();
  scene.voxel = 0.25;
  for (std::size_t k = 0; k < scene.frames.size(); ++k) {
    Frame& f = scene.frames[k];
    f.contacts = {};
    f.particles.position[2].back() = k == 0 ? f.box.hi[2] + 0.9 * scene.cutoff : f.box.lo[2] - 0.9 * scene.cutoff;
    f.particles.type.back() = 1;
  }
  Pipeline p = scene.pipeline({"phi"});
  p.window = 1;
  const Result r = run(p, scene.frames);
  for (const Written& w : r.record.times) {
    const auto bounds = w.field("phi").topology->bounds().value();
    EXPECT_LE(r.record.layouts[0].first.z, bounds.first.z);
    EXPECT_GE(r.record.layouts[0].last.z, bounds.last.z);
  }
}

// A frame in which nothing is selected counts in the mean; a run without any material is refused.
TEST(Windows, FramesWithoutMaterial) {
  const Scene scene = walled_scene();
  Frame empty = scene.frames[1];
  for (int& type : empty.particles.type) type = 2;
  empty.contacts = {};
  const Pipeline p = scene.pipeline(fields);
  const std::vector<Frame> frames{scene.frames[0], empty};
  expect_mean_over(run(p, frames).only(), frames, p);
  EXPECT_THROW(run(p, {empty}), InputError);
}

// No particle at all is a valid snapshot.
TEST(Windows, FramesWithoutParticles) {
  const Scene scene = walled_scene();
  Frame empty = scene.frames[1];
  empty.particles = {};
  empty.contacts = {};
  const Pipeline p = scene.pipeline({"phi", "temperature", "kinetic_stress", "contact_stress"});
  const Result r = run(p, {scene.frames[0], empty});
  const Result alone = run(p, {scene.frames[0]});
  r.only().field("phi").for_each_active([&](const Coord& c) {
    EXPECT_FLOAT_EQ(2 * r.only().field("phi").at(c), alone.only().field("phi").at(c));
    EXPECT_FLOAT_EQ(2 * r.only().field("contact_stress").at(c, 8), alone.only().field("contact_stress").at(c, 8));
  });
  EXPECT_THROW(run(p, {empty}), InputError);
}

// Material by id and by a region of the wrapped position; contacts count whatever is selected.
TEST(Windows, SelectionByIdAndRegion) {
  const Scene scene = periodic_scene();
  Pipeline p = scene.pipeline(fields);
  p.frames.stop = 1;
  p.select.ids = {100, 500};
  // A slab as wide as the box across x and y and thicker than the kernel, so that u can be formed around every grain.
  p.select.region = {{-1.3, 0.7, -1.0}, {5.2, 6.7, 4.0}};
  const Result r = run(p, scene.frames);
  EXPECT_LT(material(scene.frames[0], p.select).size(), scene.frames[0].particles.size() / 2 + 100);
  expect_mean_over(r.only(), {scene.frames[0]}, p);
}

}  // namespace
}  // namespace grainvdb::testing::windows_test
