#include "tune/tracer_error.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace grainvdb::tracer_error_test {
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

}  // namespace
}  // namespace grainvdb::tracer_error_test
