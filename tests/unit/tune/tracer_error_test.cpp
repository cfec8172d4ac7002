#include "tune/tracer_error.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "support/memory_source.hpp"

namespace grainvdb::testing::tracer_error_test {
namespace {

/// Tracers that have gone `speed` · t along x and as far along y.
TracerPaths paths(std::vector<double> times, const std::vector<double>& speeds, const std::vector<TracerStop>& stop) {
  TracerPaths result;
  for (const double t : times) {
    Columns3 d;
    for (const double v : speeds) {
      d[0].push_back(v * t);
      d[1].push_back(v * t);
      d[2].push_back(0);
    }
    result.displacement.push_back(std::move(d));
    result.stop.push_back(stop);
  }
  result.time = std::move(times);
  return result;
}

constexpr TracerStop moving = TracerStop::moving;

// At t = 2: distances √2 · 2 · (0, 0.1) = 0, 0.28, in diameters of 0.5.
TEST(PositionError, IsTheDistanceAtTheLastCommonTime) {
  const TracerPaths reference = paths({0, 1, 2, 3}, {1, 2}, {moving, moving});
  const TracerPaths found = paths({0, 2, 4}, {1, 2.1}, {moving, moving});
  const FieldError e = position_error(reference, found, 0.5);
  EXPECT_EQ(e.field, "position");
  EXPECT_EQ(e.points, 2U);
  const double farthest = std::sqrt(2) * 0.2 / 0.5;
  EXPECT_NEAR(e.largest, farthest, 1e-12);
  EXPECT_NEAR(e.rms, farthest / std::sqrt(2), 1e-12);
  EXPECT_EQ(position_error(reference, reference, 0.5).rms, 0);
}

TEST(PositionError, CountsThoseThatMoveInTheReferenceAlone) {
  const TracerPaths reference = paths({0, 1}, {1, 2, 3}, {moving, moving, TracerStop::left_material});
  const TracerPaths found = paths({0, 1}, {1, 2, 4}, {moving, TracerStop::masked, moving});
  const FieldError e = position_error(reference, found, 1);
  EXPECT_EQ(e.points, 1U);
  EXPECT_EQ(e.undefined, 1U);
  EXPECT_EQ(e.rms, 0);
}

TEST(PositionError, HasNoValueWithoutACommonTime) {
  const TracerPaths reference = paths({0, 1}, {1}, {moving});
  EXPECT_EQ(position_error(reference, paths({0, 0.5}, {1}, {moving}), 1).points, 0U);
  EXPECT_EQ(position_error(reference, {}, 1).points, 0U);
}

TEST(PathSink, KeepsNoMoreThanTenThousandTracers) {
  TracerPaths kept;
  PathSink sink(kept);
  TracerSample sample;
  for (auto& column : sample.displacement) column.assign(25'000, 1.5);
  sample.stop.assign(25'000, moving);
  sample.time = 3;
  sink.write(sample);
  EXPECT_EQ(kept.stop.at(0).size(), 8334U);  // one in three
  EXPECT_EQ(kept.displacement.at(0)[2].size(), 8334U);
  EXPECT_EQ(kept.time.at(0), 3);
}

Frame grains(std::int64_t step, const std::vector<double>& radius) {
  Frame frame;
  frame.step = step;
  frame.box = {{0, 0, 0}, {10, 10, 10}, {true, true, true}};
  for (std::size_t n = 0; n < radius.size(); ++n) {
    frame.particles.id.push_back(static_cast<std::int64_t>(n) + 1);
    for (auto& column : frame.particles.position) column.push_back(1.0 + static_cast<double>(n));
    frame.particles.radius.push_back(radius[n]);
    frame.particles.type.push_back(1);
  }
  return frame;
}

TEST(MeanDiameterOf, IsThatOfTheFirstFrameWithMaterial) {
  MemorySource source({grains(0, {}), grains(1, {1, 2}), grains(2, {5})});
  EXPECT_EQ(mean_diameter_of({}, source), 3);
  MemorySource nothing({grains(0, {})});
  EXPECT_THROW(mean_diameter_of({}, nothing), InputError);
}

TEST(MeanDiameterOf, NamesTheTypesThatThereAre) {
  MemorySource source({grains(0, {}), grains(1, {1, 2})});
  Pipeline pipeline;
  pipeline.select.types = {7};
  try {
    mean_diameter_of(pipeline, source);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("found type 1 at step 1; expected at least one particle that select "
                                                   "keeps, which wants type 7"));
  }
}

/// Its first frame cannot be read.
class BadFirstFrame final : public MemorySource {
 public:
  using MemorySource::MemorySource;
  Frame read(std::size_t k, ColumnSet wanted) override {
    if (k == 0) throw InputError({{"first", 0}, "a bad frame", {}, {}, {}});
    return MemorySource::read(k, wanted);
  }
};

TEST(MeanDiameterOf, PassesOverBadFramesWhereTheInputSaysSo) {
  BadFirstFrame source({grains(0, {7}), grains(1, {1, 2})});
  Pipeline pipeline;
  EXPECT_THROW(mean_diameter_of(pipeline, source), InputError);
  pipeline.input.on_error = OnError::skip_frame;
  EXPECT_EQ(mean_diameter_of(pipeline, source), 3);
  BadFirstFrame alone({grains(0, {7})});
  EXPECT_THROW(mean_diameter_of(pipeline, alone), InputError);
}

}  // namespace
}  // namespace grainvdb::testing::tracer_error_test
