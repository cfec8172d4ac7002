#include "grainvdb/flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random.hpp"
#include "trace/flow_blocks.hpp"
#include "trace/leaf_index.hpp"
#include "unit/trace/fields.hpp"

namespace grainvdb::flow_test {
namespace {

using testing::field_of;
using testing::grid_of;
using ::testing::HasSubstr;
using testing::Random;
using ::testing::ThrowsMessage;
using testing::voxels_between;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr auto trilinear = Interpolation::trilinear;
constexpr auto tricubic = Interpolation::tricubic;

TEST(LeafIndex, FindsEveryLeafAndNoOther) {
  Random random(7);
  std::vector<Coord> origins;
  for (int i = 0; i < 3000; ++i) {
    const auto part = [&] { return 8 * (static_cast<std::int32_t>(random.below(41)) - 20); };
    origins.push_back({part(), part(), part()});
  }
  origins.push_back({-(1 << 30), 1 << 30, 0});
  std::vector<LeafMask> masks(origins.size());
  for (LeafMask& m : masks) m.set(0);
  const Topology topology(origins, masks);
  const LeafIndex index(topology);
  std::size_t found = 0;
  for (std::int32_t x = -168; x <= 168; x += 8)
    for (std::int32_t y = -168; y <= 168; y += 8)
      for (std::int32_t z = -168; z <= 168; z += 8) {
        const auto expected = topology.find({x, y, z});
        ASSERT_EQ(index.find({x, y, z}), expected.value_or(topology.leaf_count()));
        found += expected ? 1 : 0;
      }
  EXPECT_EQ(found + 1, topology.leaf_count());
  EXPECT_EQ(index.find({-(1 << 30), 1 << 30, 0}), topology.find({-(1 << 30), 1 << 30, 0}));
  EXPECT_EQ(LeafIndex().find({0, 0, 0}), 0u);
}

Vec3 linear(const Vec3& x) {
  return {1 + 2 * x[0] - x[1] + 0.5 * x[2], -3 + x[2], 0.25 * x[0] + x[1] - 2 * x[2]};
}
constexpr std::array<double, 9> linear_gradient{2, -1, 0.5, 0, 0, 1, 0.25, 1, -2};

Vec3 quadratic(const Vec3& x) {
  return {x[0] * x[0] - x[1] * x[2], x[0] * x[1] + x[2] * x[2], 1 - x[1] * x[1] + 3 * x[0]};
}

/// A place in [lo, hi)³.
Vec3 place(Random& random, double lo, double hi) {
  return {random.uniform(lo, hi), random.uniform(lo, hi), random.uniform(lo, hi)};
}

/// What rounding of the values to float may leave in a sum of weights times values.
double rounding(double largest, double weights) {
  return 0x1p-23 * largest * weights;
}

TEST(FlowGrid, TrilinearIsExactForLinearVelocity) {
  const Lattice lattice(0.5, {-0.2, 0.1, 0.3});
  const auto grid = grid_of(lattice, voxels_between({-12, -12, -12}, {12, 12, 12}), trilinear, linear,
                            [](const Vec3& x) { return linear(x)[0]; });
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = place(random, -5, 5);
    const auto value = grid->at(x);
    ASSERT_TRUE(value);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(value->velocity[c], linear(x)[c], rounding(25, 1));
    EXPECT_NEAR(value->shear_rate, linear(x)[0], rounding(25, 1));
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(value->gradient[k], linear_gradient[k], rounding(25, 2 / 0.5));
  }
}

// The weights of Catmull-Rom splines add up to (9/8)³ or less in magnitude, those of derivatives to less than 5/2 times
// that.
TEST(FlowGrid, TricubicIsExactForQuadraticVelocity) {
  const Lattice lattice(0.5, {-0.2, 0.1, 0.3});
  const auto grid = grid_of(lattice, voxels_between({-13, -13, -13}, {13, 13, 13}), tricubic, quadratic);
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = place(random, -5, 5);
    const auto value = grid->at(x);
    ASSERT_TRUE(value);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(value->velocity[c], quadratic(x)[c], rounding(90, 2));
    EXPECT_NEAR(value->gradient[0], 2 * x[0], rounding(90, 4 / 0.5));
    EXPECT_NEAR(value->gradient[1], -x[2], rounding(90, 4 / 0.5));
    EXPECT_NEAR(value->gradient[5], 2 * x[2], rounding(90, 4 / 0.5));
    EXPECT_EQ(value->shear_rate, 0);
  }
}

/// The largest error of interpolating sin(kx) along one axis, over its whole period.
double largest_error(Interpolation interpolation, double kh) {
  const Lattice lattice(1, {0, 0, 0});
  const auto grid = grid_of(lattice, voxels_between({-4, -2, -2}, {400, 2, 2}), interpolation, [kh](const Vec3& x) {
    return Vec3{std::sin(kh * x[0]), 0, 0};
  });
  double worst = 0;
  for (double x = 1; x < 1 + 2 * std::numbers::pi / kh; x += 0.01)
    worst = std::max(worst, std::abs(grid->at({x, 0.5, 0.5})->velocity[0] - std::sin(kh * x)));
  return worst;
}

// The stated errors, (kh)²/8 and √3/108 (kh)³ = (kh)³/62, to within what the next orders add at kh = 0.1.
TEST(FlowGrid, ErrorsOfInterpolationAreTheStatedOnes) {
  EXPECT_NEAR(largest_error(trilinear, 0.1) / (0.01 / 8), 1, 0.02);
  EXPECT_NEAR(largest_error(tricubic, 0.1) / (0.001 * std::sqrt(3) / 108), 1, 0.05);
  EXPECT_NEAR(1 / (std::sqrt(3) / 108), 62, 0.5);
}

// 21, 18 and 20 voxels: leaves end in the middle of a period, and the image of a voxel lies elsewhere in its leaf.
TEST(FlowGrid, PeriodsWrap) {
  Lattice lattice(0.5, {0.1, 0.2, 0.3});
  const Box box{{0, 0, 0}, {10.5, 9, 10}, {true, true, true}};
  lattice.set_periods(box);
  const Coord first{lattice.period(0)->first, lattice.period(1)->first, lattice.period(2)->first};
  const Coord last{first.x + 20, first.y + 17, first.z + 19};
  const auto wave = [&](const Vec3& x) {
    Vec3 u;
    for (std::size_t a = 0; a < 3; ++a) u[a] = std::sin(2 * std::numbers::pi * x[a] / box.hi[a]);
    return u;
  };
  for (const Interpolation interpolation : {trilinear, tricubic}) {
    const auto grid = grid_of(lattice, voxels_between(first, last), interpolation, wave);
    // k h = 0.35 at most.
    const double error = interpolation == trilinear ? 0.35 * 0.35 / 8 : 1.1 * std::pow(0.35, 3) / 62;
    Random random(3);
    for (int i = 0; i < 3000; ++i) {
      const Vec3 x = place(random, -20, 30);
      const auto value = grid->at(x);
      ASSERT_TRUE(value);
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(value->velocity[a], wave(x)[a], error);
    }
  }
}

TEST(FlowGrid, NeedsEightVoxels) {
  const Lattice lattice(1, {0, 0, 0});
  const Coord hole{9, 7, 8}, without_velocity{3, 3, 3};
  const auto topology = voxels_between({-2, -2, -2}, {17, 17, 17}, [&](const Coord& c) { return c != hole; });
  for (const Interpolation interpolation : {trilinear, tricubic}) {
    const auto grid = grid_of(lattice, topology, interpolation, [&](const Vec3& x) {
      return x == lattice.centre(without_velocity) ? Vec3{1, static_cast<double>(nan), 1} : linear(x);
    });
    Random random(4);
    std::size_t undefined = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 x = place(random, -3, 19);
      const auto near = [&](const Coord& c) {
        bool all = true;
        for (int a = 0; a < 3; ++a) all = all && std::abs(x[static_cast<std::size_t>(a)] - lattice.centre(a, c[a])) < 1;
        return all;
      };
      const bool outside = std::any_of(x.begin(), x.end(), [](double v) { return v < -1.5 || v >= 17.5; });
      const bool defined = !outside && !near(hole) && !near(without_velocity);
      const auto value = grid->at(x);
      ASSERT_EQ(value.has_value(), defined) << x[0] << " " << x[1] << " " << x[2];
      undefined += defined ? 0 : 1;
      if (!value) continue;
      // A linear velocity is interpolated exactly by both methods, so that the fall-back does not show.
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(value->velocity[c], linear(x)[c], rounding(80, 2));
    }
    EXPECT_GT(undefined, 100u);
    EXPECT_FALSE(grid->at({1e300, 0, 0}));
    EXPECT_FALSE(grid->at({0, -1e12, 0}));
    EXPECT_FALSE(grid->at({0, 0, static_cast<double>(nan)}));
  }
}

// One missing voxel two away leaves the trilinear value: of a quadratic velocity it differs from the tricubic one.
TEST(FlowGrid, TricubicFallsBackWhereOnlyEightAreThere) {
  const Lattice lattice(1, {0, 0, 0});
  const auto all = voxels_between({0, 0, 0}, {7, 7, 7});
  const auto some = voxels_between({0, 0, 0}, {7, 7, 7}, [](const Coord& c) { return c != Coord{5, 3, 3}; });
  const Vec3 x{4.25, 4, 4};  // between voxels 3 and 4
  const Vec3 cubic = grid_of(lattice, all, tricubic, quadratic)->at(x)->velocity;
  const Vec3 linear_one = grid_of(lattice, all, trilinear, quadratic)->at(x)->velocity;
  const Vec3 fallen_back = grid_of(lattice, some, tricubic, quadratic)->at(x)->velocity;
  EXPECT_GT(std::abs(cubic[0] - linear_one[0]), 0.1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(fallen_back[c], linear_one[c], 1e-14 * 60);
}

TEST(FlowGrid, UndefinedShearRateLeavesTheVelocity) {
  const Lattice lattice(1, {0, 0, 0});
  for (const Interpolation interpolation : {trilinear, tricubic}) {
    const auto grid = grid_of(lattice, voxels_between({0, 0, 0}, {7, 7, 7}), interpolation, linear,
                              [](const Vec3& x) { return x[0] < 3 ? static_cast<double>(nan) : 1.0; });
    const auto value = grid->at({3, 4, 4});
    ASSERT_TRUE(value);
    EXPECT_TRUE(std::isnan(value->shear_rate));
    EXPECT_NEAR(value->velocity[1], linear({3, 4, 4})[1], 1e-5);
    EXPECT_EQ(grid->at({3.6, 4, 4})->shear_rate, 1);  // the stencil of 64 still reaches voxel 2
  }
}

TEST(FlowGrid, TakesTheStatedMemory) {
  const Lattice lattice(1, {0, 0, 0});
  const auto topology = voxels_between({0, 0, 0}, {79, 79, 79});
  const auto per_leaf = [&](Interpolation interpolation) {
    return static_cast<double>(grid_of(lattice, topology, interpolation, linear)->bytes()) / 1001;
  };
  EXPECT_NEAR(per_leaf(trilinear), 11.7e3, 100);
  EXPECT_NEAR(per_leaf(tricubic), 21.3e3, 100);
}

TEST(FlowGrid, RefusesFieldsThatDoNotFit) {
  const Lattice lattice(1, {0, 0, 0});
  const auto topology = voxels_between({0, 0, 0}, {7, 7, 7});
  const auto constant = [](const Vec3&, int) { return 1.0; };
  const SparseField velocity = field_of("velocity", 3, lattice, topology, constant);
  const SparseField scalar = field_of("phi", 1, lattice, topology, constant);
  const SparseField elsewhere = field_of("phi", 1, lattice, voxels_between({0, 0, 0}, {7, 7, 7}), constant);
  const auto make = [&](const SparseField& u, const SparseField* rate) { FlowGrid(lattice, u, rate, trilinear); };
  const auto message = [](const char* text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); };
  EXPECT_THAT([&] { make(scalar, nullptr); }, message("3 components, found 1"));
  EXPECT_THAT([&] { make(velocity, &velocity); }, message("1 component, found 3"));
  EXPECT_THAT([&] { make(velocity, &elsewhere); }, message("share the topology"));
}

TEST(Flow, RefusesFramesThatDoNotFit) {
  const Lattice lattice(1, {0, 0, 0}), shifted(1, {0.5, 0, 0});
  const auto topology = voxels_between({0, 0, 0}, {7, 7, 7});
  const auto grid = grid_of(lattice, topology, trilinear, linear);
  const auto message = [](const char* text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); };
  for (const double t1 : {1.0, 2.0, static_cast<double>(nan)})
    EXPECT_THAT([&] { Flow(grid, 2, grid, t1); }, message("in order of time"));
  EXPECT_THAT([&] { Flow(grid, 0, grid_of(shifted, topology, trilinear, linear), 1); }, message("one lattice"));
  EXPECT_THAT([&] { Flow(grid, 0, grid_of(lattice, topology, tricubic, linear), 1); }, message("interpolation"));
  EXPECT_TRUE(Flow(grid).steady());
  EXPECT_FALSE(Flow(grid, 0, grid, 1).steady());
}

}  // namespace
}  // namespace grainvdb::flow_test
