#include "measure/streamlines.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::testing::streamlines_test {
namespace {

const Lattice lattice(0.5, {0, 0, 0});

// Those of the kinematic flow, upwards: x = x0 √(z/z0). Directions are interpolated linearly over voxels of ½: their
// curvature, below 3e-2 here, times h²/8 is 1e-3 at worst, half of which builds up along 30 (measured: 3e-4).
TEST(Streamlines, OfTheKinematicFlowAreParabolas) {
  const KinematicFlow flow{2.28, 1};
  const auto topology = voxels_between({0, 0, 8}, {40, 4, 100});
  const SparseField up = field_of("spot_drift", 3, lattice, topology, [&](const Vec3& x, int k) {
    return 1e-5 * (k == 0 ? -flow.sideways(x[0], x[2]) : k == 2 ? flow.downward(x[0], x[2]) : 0);
  });
  const Vec3 start{3, 1, 10};
  const auto lines = streamlines(lattice, open_box({0, 0, 0}, {50, 50, 60}), up, std::vector<Vec3>{start}, 0.25, 30);
  ASSERT_EQ(lines.size(), 1U);
  const std::vector<Vec3>& points = lines[0].points;
  ASSERT_EQ(points.size(), 121U);
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_NEAR(points[n][0], KinematicFlow::streamline(3, 10, points[n][2]), 1e-3);
    EXPECT_EQ(points[n][1], 1);
    if (n == 0) continue;
    const double way = std::hypot(points[n][0] - points[n - 1][0], points[n][2] - points[n - 1][2]);
    EXPECT_NEAR(way, 0.25, 1e-4);
  }
  EXPECT_GT(points.back()[2], 39);
}

// Whatever the length of the vectors: the way counts.
TEST(Streamlines, EndWhereTheFieldDoes) {
  const auto topology = voxels_between({0, 0, 0}, {20, 4, 4});
  const SparseField along = field_of("a", 3, lattice, topology, [](const Vec3& x, int k) {
    return k == 0 ? (x[0] < 7 ? 1e4 + x[0] : std::nan("")) : 0.0;
  });
  const std::vector<Vec3> starts{{1, 1, 1}, {30, 1, 1}};
  const auto lines = streamlines(lattice, open_box({0, 0, 0}, {50, 50, 50}), along, starts, 0.5, 100);
  ASSERT_FALSE(lines[0].points.empty());
  EXPECT_NEAR(lines[0].points.back()[0], 6.75, 0.5);  // the last voxel centre with a value
  EXPECT_TRUE(lines[1].points.empty());
}

TEST(Streamlines, AreUnwrapped) {
  Lattice periodic = lattice;
  const Box box{{0, 0, 0}, {8, 50, 50}, {true, false, false}};
  periodic.set_periods(box);
  const auto topology = voxels_between({0, 0, 0}, {15, 4, 4});
  const SparseField along = field_of("a", 3, periodic, topology, [](const Vec3&, int k) { return k == 0 ? 2.0 : 0.0; });
  const auto lines = streamlines(periodic, box, along, std::vector<Vec3>{{1, 1, 1}}, 0.5, 20);
  ASSERT_EQ(lines[0].points.size(), 41U);
  EXPECT_NEAR(lines[0].points.back()[0], 21, 1e-5);
}

}  // namespace
}  // namespace grainvdb::testing::streamlines_test
