#include "grainvdb/spot_theory.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"

namespace grainvdb::spot_theory_test {
namespace {

double ball(double radius) {
  return 4 * std::numbers::pi / 3 * radius * radius * radius;
}

// V_s = 0.2 V_p and 79.8 grains: α = 1/399, and b_p of both conventions of b.
TEST(SpotTheory, GrainsSpreadLessThanSpots) {
  const double influence = spot_influence(0.2, 1, 79.8);
  EXPECT_DOUBLE_EQ(influence, 1 / 399.0);
  EXPECT_NEAR(grain_diffusion(influence, 2.28), 0.00571, 0.000005);
  EXPECT_NEAR(grain_diffusion(influence, 1.14), 0.00286, 0.000005);
}

// ρ = 1 + x/2 - z/5: ∫ρ over the ball is its volume times the value in the middle, ∫∇ρ that times the slope.
TEST(MeanField, OfAUniformSlope) {
  const SpotCloud cloud{[](const Vec3& x) { return 1 + x[0] / 2 - x[2] / 5; },
                        [](const Vec3&) {
                          return Vec3{0.5, 0, -0.2};
                        },
                        {0.1, 0, 3},
                        {0.7, 0.6, 0.1}};
  const SpotReach reach{1.5, 0.01, 1};
  const Vec3 at{2, -1, 0.5};
  const double spots = (1 + 1 - 0.1) * ball(1.5);
  const MeanField f = mean_field(cloud, reach, at);
  EXPECT_NEAR(f.drift[0], -0.01 * (0.1 * spots - 2 * 0.7 * 0.5 * ball(1.5)), 1e-13);
  EXPECT_NEAR(f.drift[1], 0, 1e-13);
  EXPECT_NEAR(f.drift[2], -0.01 * (3 * spots - 2 * 0.1 * -0.2 * ball(1.5)), 1e-13);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(f.diffusivity[i], 1e-4 * spots * cloud.diffusivity[i], 1e-14);
  const MeanField halfway = mean_field(cloud, {1.5, 0.01, 0.5}, at);
  EXPECT_NEAR(halfway.drift[0], -0.01 * (0.1 * spots - 0.7 * 0.5 * ball(1.5)), 1e-13);
}

// ρ = (x² + y² + z²)^5, of degree 10: ∫ρ dV = 4π R¹³/13 about the origin. (x y z)² also tests the angles: 4π
// R⁹/(9·105).
TEST(MeanField, ExactForPolynomials) {
  const auto none = [](const Vec3&) { return Vec3{}; };
  const auto total = [&](const std::function<double(const Vec3&)>& density) {
    return -mean_field({density, none, {0, 0, 1}, {}}, {1.2, 1, 1}, {}).drift[2];
  };
  const double radial = 4 * std::numbers::pi * std::pow(1.2, 13) / 13;
  EXPECT_NEAR(total([](const Vec3& x) { return std::pow(x[0] * x[0] + x[1] * x[1] + x[2] * x[2], 5); }), radial,
              1e-13 * radial);
  const double mixed = 4 * std::numbers::pi * std::pow(1.2, 9) / (9 * 105);
  EXPECT_NEAR(total([](const Vec3& x) { return std::pow(x[0] * x[1] * x[2], 2); }), mixed, 1e-13 * mixed);
}

/// Spots that rise from a slot with velocity 2.8 and spread as b of the kinematic model says, as many as make its flow.
SpotCloud rising_spots(const KinematicFlow& flow, double carried_by_one) {
  constexpr double rise = 2.8;
  const double number = 1 / (carried_by_one * rise);
  return {[=](const Vec3& x) { return number * flow.downward(x[0], x[2]); },
          [=](const Vec3& x) {
            return Vec3{number * flow.sideways(x[0], x[2]) / flow.b, 0, 0};  // b ∂v/∂x; that along z is not asked for
          },
          {0, 0, rise},
          {flow.b * rise, 0, 0}};
}

// The ball widens the profile by the variance of one coordinate over it, R²/5; its mean over z changes nothing, for 2bz
// is linear. Sums over a step of 1 are exact to rounding; the quadrature is good to 1e-9 of the profile here.
TEST(MeanField, SpotsFromASlotMakeTheKinematicFlow) {
  const KinematicFlow flow{2.28, 1.3};
  constexpr double radius = 2.6, z = 30;
  const SpotReach reach{radius, 1 / 399.0, 0.5};
  const SpotCloud cloud = rising_spots(flow, reach.influence * ball(radius));
  double sum = 0;
  double square = 0;
  for (double x = -120; x <= 120; x += 1) {
    const MeanField f = mean_field(cloud, reach, {x, 0, z});
    sum -= f.drift[2];
    square -= f.drift[2] * x * x;
  }
  EXPECT_NEAR(sum, flow.discharge, 1e-8);
  EXPECT_NEAR(square / sum, flow.variance(z) + radius * radius / 5, 1e-5);

  // Where the ball is small, halfway influence gives u = b ∂v/∂x, that at the end of steps twice as much.
  const SpotReach small{0.01, 1, 0.5};
  const SpotCloud dense = rising_spots(flow, ball(0.01));
  EXPECT_NEAR(mean_field(dense, small, {6, 0, z}).drift[0], flow.sideways(6, z), 1e-6);
  EXPECT_NEAR(mean_field(dense, small, {6, 0, z}).drift[2], -flow.downward(6, z), 1e-6);
  EXPECT_NEAR(mean_field(dense, {0.01, 1, 1}, {6, 0, z}).drift[0], 2 * flow.sideways(6, z), 1e-6);
}

}  // namespace
}  // namespace grainvdb::spot_theory_test
