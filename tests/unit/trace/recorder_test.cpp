#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grainvdb/tracer_recorder.hpp"
#include "support/random.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::recorder_test {
namespace {

using ::testing::ElementsAre;
using testing::field_of;
using testing::grid_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::NanSensitiveFloatEq;
using testing::open_box;
using ::testing::Pair;
using testing::Random;
using ::testing::ThrowsMessage;
using testing::voxels_between;
using enum TracerStop;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr auto trilinear = Interpolation::trilinear;

const Lattice lattice(1, {0, 0, 0});
const Box box = open_box({0, 0, 0}, {40, 8, 8});

std::shared_ptr<const Topology> slab() {
  return voxels_between({0, 0, 0}, {39, 7, 7});
}

/// u = (2, 0, 0), |γ̇| = 3.
Flow to_the_right(const std::shared_ptr<const Topology>& topology) {
  return Flow(grid_of(
      lattice, topology, trilinear,
      [](const Vec3&) {
        return Vec3{2, 0, 0};
      },
      [](const Vec3&) { return 3.0; }));
}

double linear(const Vec3& x, int component) {
  return 1 + component + (component + 1) * x[0] - 0.5 * component * x[1] + x[2];
}

TEST(TracerRecorder, SamplesFieldsOfAnyNumberOfComponents) {
  Lattice wrapped(0.5, {0.1, 0.2, 0.3});
  const Box periodic{{0, 0, 0}, {10.5, 9, 10}, {false, true, false}};
  wrapped.set_periods(periodic);
  const std::int32_t first = wrapped.period(1)->first;
  const auto topology = voxels_between({-2, first, -2}, {22, first + 17, 21});
  // Linear along the open axes, a whole number of waves along the periodic one.
  const auto value = [](const Vec3& x, int c) {
    return linear({x[0], 0, x[2]}, c) + std::cos(2 * std::numbers::pi * x[1] / 9);
  };
  const SparseField scalar = field_of("phi", 1, wrapped, topology, value);
  const SparseField vector = field_of("velocity", 3, wrapped, topology, value);
  const SparseField tensor = field_of("stress", 9, wrapped, topology, value);
  Random random(3);
  std::vector<Vec3> places;
  for (int i = 0; i < 2000; ++i)
    places.push_back({random.uniform(0.5, 10), random.uniform(-9, 18), random.uniform(0.5, 9.5)});
  for (const Interpolation interpolation : {trilinear, Interpolation::tricubic}) {
    const Flow flow(grid_of(wrapped, topology, interpolation, [](const Vec3&) { return Vec3{}; }));
    Tracers tracers(seeds_at(places), periodic, flow, 0, {.stepping = FixedSteps{1}});
    TracerRecorder recorder(tracers, wrapped, {.fields = {scalar.meta(), vector.meta(), tensor.meta()}}, interpolation);
    const TracerSample& sample = recorder.record(tracers, {&scalar, &vector, &tensor}, nullptr, 7);
    EXPECT_EQ(sample.step, 7);
    // Interpolation errors of the wave at kh = 0.35, and rounding of values up to 120.
    const double error = (interpolation == trilinear ? 0.35 * 0.35 / 8 : 1.1 * 0.35 * 0.35 * 0.35 / 62) + 4e-5;
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t f = 0; f < 3; ++f) {
        const std::size_t components = f == 0 ? 1 : f == 1 ? 3 : 9;
        for (std::size_t c = 0; c < components; ++c)
          ASSERT_NEAR(sample.fields[f][components * i + c], value(places[i], static_cast<int>(c)), error);
      }
    }
    EXPECT_TRUE(recorder.undefined().empty());
  }
}

TEST(TracerRecorder, ShowsTimesPlacesAndStrains) {
  Lattice wrapped(1, {0, 0, 0});
  const Box periodic{{0, 0, 0}, {40, 8, 8}, {true, false, false}};
  wrapped.set_periods(periodic);
  const Flow flow(grid_of(
      wrapped, slab(), trilinear,
      [](const Vec3&) {
        return Vec3{2, 0, 0.125};
      },
      [](const Vec3&) { return 3.0; }));
  Tracers tracers(seeds_at(std::vector<Vec3>{{35, 4, 2}, {-1, 3, 3}}), periodic, flow, 10,
                  {.stepping = FixedSteps{0.25}, .step_numbers = true});
  TracerRecorder all(tracers, wrapped, {.strain = true, .step_numbers = true}, trilinear);
  TracerRecorder least(tracers, wrapped, {}, trilinear);
  const TracerSample before = all.record(tracers, {}, nullptr, 0);
  EXPECT_EQ(before.time, 10);
  EXPECT_THAT(before.position[0], ElementsAre(35, 39));
  EXPECT_THAT(before.image[0], ElementsAre(0, -1));
  EXPECT_THAT(before.displacement[0], ElementsAre(0, 0));
  EXPECT_TRUE(std::isnan(before.courant[0]) && std::isnan(before.gradient_number[1]));
  tracers.advance(flow, 14);
  const TracerSample& after = all.record(tracers, {}, nullptr, 16);
  EXPECT_EQ(after.time, 14);
  EXPECT_EQ(after.step, 16);
  EXPECT_THAT(after.position[0], ElementsAre(3, 7));
  EXPECT_THAT(after.image[0], ElementsAre(1, 0));
  EXPECT_THAT(after.displacement[0], ElementsAre(8, 8));
  EXPECT_THAT(after.displacement[2], ElementsAre(0.5, 0.5));
  EXPECT_THAT(after.strain, ElementsAre(12, 12));
  EXPECT_THAT(after.courant, ElementsAre(std::hypot(2, 0.125) / 4, std::hypot(2, 0.125) / 4));
  EXPECT_THAT(after.gradient_number, ElementsAre(0, 0));
  EXPECT_THAT(after.stop, ElementsAre(moving, moving));
  EXPECT_TRUE(std::isnan(after.stop_time[0]));
  const TracerSample& bare = least.record(tracers, {}, nullptr, 16);
  EXPECT_THAT(bare.strain, IsEmpty());
  EXPECT_THAT(bare.courant, IsEmpty());
  EXPECT_THAT(bare.gradient_number, IsEmpty());
  EXPECT_THAT(bare.fields, IsEmpty());
}

// The material ends between 9.5 and 10.5; the tracer is there at t = 3.75, between the samples at t = 3 and 4.
TEST(TracerRecorder, TracersThatStoodStillRepeatTheirLastSample) {
  const auto topology = voxels_between({0, 0, 0}, {9, 7, 7});
  const Flow flow = to_the_right(topology);
  const SparseField phi = field_of("phi", 1, lattice, topology, linear);
  Tracers tracers(seeds_at(std::vector<Vec3>{{2, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{0.5}});
  TracerRecorder recorder(tracers, lattice, {.fields = {phi.meta()}, .strain = true}, trilinear);
  for (int t = 0; t <= 6; ++t) {
    if (t > 0) tracers.advance(flow, t);
    const TracerSample& sample = recorder.record(tracers, {&phi}, nullptr, t);
    const double moved_for = std::min(t, 3);
    EXPECT_EQ(sample.time, t);
    EXPECT_EQ(sample.position[0][0], 2 + 2 * moved_for);
    EXPECT_EQ(sample.displacement[0][0], 2 * moved_for);
    EXPECT_EQ(sample.strain[0], 3 * moved_for);
    EXPECT_NEAR(sample.fields[0][0], linear({2 + 2 * moved_for, 4, 4}, 0), 1e-5);
    EXPECT_EQ(sample.stop[0], t < 4 ? moving : left_material);
    if (t < 4) {
      EXPECT_TRUE(std::isnan(sample.stop_time[0]));
    } else {
      EXPECT_NEAR(sample.stop_time[0], 3.75, 0.5 / 128);
    }
  }
  EXPECT_TRUE(recorder.undefined().empty());  // the fields have stopped nobody
}

/// μ, undefined from voxel 10 on for two reasons.
struct Masked {
  std::shared_ptr<const Topology> topology = slab();
  SparseField phi = field_of("phi", 1, lattice, topology, linear);
  SparseField mu = field_of("mu", 1, lattice, topology, [](const Vec3& x, int) { return x[0] > 10 ? nan : x[0]; });
  Mask mask{topology};

  Masked() {
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      for (int v = 0; v < leaf_size; ++v) {
        const Coord c = voxel_at(topology->origin(l), v);
        if (c.x >= 10) mask.add(l, v, Reason::low_pressure);
        if (c.x >= 11) mask.add(l, v, Reason::no_shear_stress);
        if (c.x < 5) mask.add(l, v, Reason::one_sided_gradient);  // of another field: says nothing about μ
      }
  }
  RecordedColumns columns() const { return {.fields = {phi.meta(), mu.meta()}}; }
};

TEST(TracerRecorder, UndefinedFieldsStopTracers) {
  const Masked fields;
  const Flow flow = to_the_right(fields.topology);
  Tracers tracers(seeds_at(std::vector<Vec3>{{2, 4, 4}, {12, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{0.5}});
  TracerRecorder recorder(tracers, lattice, fields.columns(), trilinear);
  const TracerSample& sample = recorder.record(tracers, {&fields.phi, &fields.mu}, &fields.mask, 0);
  EXPECT_THAT(sample.stop, ElementsAre(moving, masked));
  EXPECT_THAT(sample.fields[1], ElementsAre(NanSensitiveFloatEq(2.0F), NanSensitiveFloatEq(NAN)));
  EXPECT_NEAR(sample.fields[0][1], linear({12, 4, 4}, 0), 1e-5);  // what is defined at the seed is shown
  for (int t = 1; t <= 6; ++t) {
    tracers.advance(flow, t);
    recorder.record(tracers, {&fields.phi, &fields.mu}, &fields.mask, t);
    const double moved_for = std::min(t, 3);  // at t = 4 it is between voxels 9 and 10
    EXPECT_EQ(sample.stop[0], t < 4 ? moving : masked);
    EXPECT_EQ(sample.position[0][0], 2 + 2 * moved_for);
    EXPECT_NEAR(sample.fields[1][0], 2 + 2 * moved_for, 1e-6);
    EXPECT_NEAR(sample.fields[0][0], linear({2 + 2 * moved_for, 4, 4}, 0), 1e-5);
  }
  EXPECT_EQ(sample.stop_time[0], 4);
  EXPECT_THAT(recorder.undefined(), ElementsAre(Pair(Reason::low_pressure, 2), Pair(Reason::no_shear_stress, 1)));
}

TEST(TracerRecorder, UndefinedFieldsAreRecordedAsNanWhereTracersCarryOn) {
  const Masked fields;
  const Flow flow = to_the_right(fields.topology);
  Tracers tracers(seeds_at(std::vector<Vec3>{{2, 4, 4}}), box, flow, 0,
                  {.stepping = FixedSteps{0.5}, .on_undefined = OnUndefined::carry_on});
  TracerRecorder recorder(tracers, lattice, fields.columns(), trilinear);
  for (int t = 0; t <= 6; ++t) {
    if (t > 0) tracers.advance(flow, t);
    const TracerSample& sample = recorder.record(tracers, {&fields.phi, &fields.mu}, &fields.mask, t);
    EXPECT_EQ(sample.stop[0], moving);
    EXPECT_NEAR(sample.position[0][0], 2 + 2 * t, 1e-13);
    EXPECT_EQ(std::isnan(sample.fields[1][0]), t >= 4);
    EXPECT_NEAR(sample.fields[0][0], linear({2.0 + 2 * t, 4, 4}, 0), 1e-5);
  }
  EXPECT_THAT(recorder.undefined(), ElementsAre(Pair(Reason::low_pressure, 3), Pair(Reason::no_shear_stress, 2)));
}

// Sums such as φ are stored as 0 where no kernel reaches: a sample that mixes such voxels in is no value.
TEST(TracerRecorder, InactiveNeighboursLeaveNoValue) {
  const auto narrow = voxels_between({0, 0, 0}, {9, 7, 7});
  SparseField phi({"phi", "1", 1, "", "", 0.0F}, narrow, lattice);
  for (std::size_t l = 0; l < narrow->leaf_count(); ++l) narrow->mask(l).for_each([&](int v) { phi.leaf(l)[v] = 1; });
  const Flow flow = to_the_right(slab());
  for (const OnUndefined policy : {OnUndefined::stop, OnUndefined::carry_on}) {
    Tracers tracers(seeds_at(std::vector<Vec3>{{9, 4, 4}, {9.75, 4, 4}, {30, 4, 4}, {5, 4, 4}}), box, flow, 0,
                    {.stepping = FixedSteps{0.5}, .on_undefined = policy});
    TracerRecorder recorder(tracers, lattice, {.fields = {phi.meta()}}, Interpolation::tricubic);
    const TracerSample& sample = recorder.record(tracers, {&phi}, nullptr, 0);
    EXPECT_THAT(sample.fields[0], ElementsAre(1, NanSensitiveFloatEq(NAN), NanSensitiveFloatEq(NAN), 1));
    const TracerStop outcome = policy == OnUndefined::stop ? left_material : moving;
    EXPECT_THAT(sample.stop, ElementsAre(moving, outcome, outcome, moving));
    EXPECT_THAT(recorder.undefined(), ElementsAre(Pair(Reason::outside, 2)));
  }
}

TEST(TracerRecorder, SeedsOutsideAreShownWithTheirCode) {
  const Flow flow = to_the_right(slab());
  const SparseField phi = field_of("phi", 1, lattice, slab(), linear);
  Tracers tracers(seeds_at(std::vector<Vec3>{{1e300, 4, 4}, {0.25, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{1}});
  TracerRecorder recorder(tracers, lattice, {.fields = {phi.meta()}}, trilinear);
  for (int t = 0; t < 2; ++t) {
    const TracerSample& sample = recorder.record(tracers, {&phi}, nullptr, t);
    EXPECT_THAT(sample.stop, ElementsAre(left_domain, left_material));
    EXPECT_THAT(sample.position[0], ElementsAre(1e300, 0.25));
    EXPECT_THAT(sample.stop_time, ElementsAre(0, 0));
    EXPECT_TRUE(std::isnan(sample.fields[0][0]) && std::isnan(sample.fields[0][1]));
    tracers.advance(flow, t + 1);
  }
}

// The topology of frames changes: fields are found anew in each.
TEST(TracerRecorder, FieldsMayChangeTheirTopology) {
  const Flow flow = to_the_right(slab());
  Tracers tracers(seeds_at(std::vector<Vec3>{{4, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{1}});
  const auto later = voxels_between({-20, -9, -9}, {39, 20, 20});
  const SparseField early_phi = field_of("phi", 1, lattice, slab(), linear);
  const SparseField late_phi = field_of("phi", 1, lattice, later, [](const Vec3& x, int) { return 2 * x[0]; });
  TracerRecorder recorder(tracers, lattice, {.fields = {early_phi.meta()}}, trilinear);
  EXPECT_NEAR(recorder.record(tracers, {&early_phi}, nullptr, 0).fields[0][0], linear({4, 4, 4}, 0), 1e-5);
  tracers.advance(flow, 3);
  EXPECT_NEAR(recorder.record(tracers, {&late_phi}, nullptr, 1).fields[0][0], 20, 1e-5);
}

TEST(TracerRecorder, HasTheSameBytesForAnyNumberOfThreads) {
  const Masked fields;
  const Flow flow = to_the_right(fields.topology);
  Random random(8);
  std::vector<Vec3> places;
  for (int i = 0; i < 5000; ++i) places.push_back({random.uniform(0, 20), random.uniform(0, 8), random.uniform(0, 8)});
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Tracers tracers(seeds_at(places), box, flow, 0, {.stepping = FixedSteps{0.5}});
    TracerRecorder recorder(tracers, lattice, fields.columns(), trilinear);
    std::vector<float> all;
    for (int t = 1; t < 4; ++t) {
      tracers.advance(flow, t);
      const TracerSample& sample = recorder.record(tracers, {&fields.phi, &fields.mu}, &fields.mask, t);
      for (const auto& values : sample.fields) all.insert(all.end(), values.begin(), values.end());
      for (const TracerStop s : sample.stop) all.push_back(static_cast<float>(s));
    }
    for (const auto& [reason, count] : recorder.undefined()) all.push_back(static_cast<float>(count));
    return all;
  };
  const std::vector<float> one = run(1), four = run(4);
  ASSERT_EQ(one.size(), four.size());
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(float)), 0);
}

TEST(TracerRecorder, RefusesWhatWasNotAnnounced) {
  const auto topology = slab();
  const Flow flow = to_the_right(topology);
  const SparseField phi = field_of("phi", 1, lattice, topology, linear),
                    mu = field_of("mu", 1, lattice, topology, linear);
  const SparseField elsewhere = field_of("mu", 1, lattice, slab(), linear);
  Tracers tracers(seeds_at(std::vector<Vec3>{{4, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{1}});
  Tracers two(seeds_at(std::vector<Vec3>{{4, 4, 4}, {5, 4, 4}}), box, flow, 0, {.stepping = FixedSteps{1}});
  const auto message = [](const char* text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); };
  EXPECT_THAT([&] { TracerRecorder(tracers, lattice, {.step_numbers = true}, trilinear); },
              message("tracers do not compute them"));
  TracerRecorder recorder(tracers, lattice, {.fields = {phi.meta(), mu.meta()}}, trilinear);
  EXPECT_THAT([&] { recorder.record(two, {&phi, &mu}, nullptr, 0); }, message("another number of tracers"));
  EXPECT_THAT([&] { recorder.record(tracers, {&phi}, nullptr, 0); }, message("another number of fields"));
  EXPECT_THAT([&] { recorder.record(tracers, {&mu, &phi}, nullptr, 0); }, message("expects phi, found mu"));
  EXPECT_THAT([&] { recorder.record(tracers, {&phi, &elsewhere}, nullptr, 0); }, message("share one topology"));
  const Mask mask(slab());
  EXPECT_THAT([&] { recorder.record(tracers, {&phi, &mu}, &mask, 0); }, message("topology of their mask"));
}

}  // namespace
}  // namespace grainvdb::recorder_test
