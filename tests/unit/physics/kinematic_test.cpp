// The closed forms of drainage against the equations that they solve.
#include "grainvdb/kinematic.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace grainvdb::kinematic_test {
namespace {

constexpr KinematicFlow flow{2.28, 1.7};
constexpr double h = 1e-3;

double first(double before, double after) {
  return (after - before) / (2 * h);
}
double second(double before, double here, double after) {
  return (after - 2 * here + before) / (h * h);
}

// Differences of step h = 1e-3 are out by h²/6 of the third derivative, here below 1e-8, and by rounding, 2⁻⁵²/h² ≈
// 2e-10 of v < 0.2 in second derivatives.
TEST(KinematicFlow, SolvesItsEquations) {
  for (double z : {5.0, 12.0, 40.0})
    for (double x : {-7.0, 0.0, 2.5, 11.0}) {
      const auto v = [](double at_x, double at_z) { return flow.downward(at_x, at_z); };
      const double v_z = first(v(x, z - h), v(x, z + h));
      const double v_x = first(v(x - h, z), v(x + h, z));
      EXPECT_NEAR(v_z, flow.b * second(v(x - h, z), v(x, z), v(x + h, z)), 2e-8);
      EXPECT_NEAR(flow.sideways(x, z), flow.b * v_x, 2e-8);
      // Incompressible: the vertical velocity is -v.
      EXPECT_NEAR(first(flow.sideways(x - h, z), flow.sideways(x + h, z)), v_z, 2e-8);
    }
}

// Sums over equal steps are exact to rounding for Gaussians some steps wide.
TEST(KinematicFlow, CarriesItsDischargeOnAWidthOfTwoBZ) {
  for (double z : {3.0, 10.0, 60.0}) {
    double sum = 0;
    double square = 0;
    for (double x = -200; x <= 200; x += 0.5) {
      sum += 0.5 * flow.downward(x, z);
      square += 0.5 * x * x * flow.downward(x, z);
    }
    EXPECT_NEAR(sum, flow.discharge, 1e-12);
    EXPECT_NEAR(square / sum, flow.variance(z), 1e-10);
    EXPECT_DOUBLE_EQ(flow.variance(z), 2 * 2.28 * z);
  }
}

// Along dx/dz = -u/v = x/(2z), by Simpson's rule in z for the time; 2000 steps leave less than 1e-9 of it.
TEST(KinematicFlow, StreamlinesAreParabolasAndTakeTheirTime) {
  const KinematicFlow unit{2.28, 1};
  constexpr double x0 = 6, z0 = 40, z1 = 10;
  EXPECT_NEAR(unit.residence(x0, z0, z1), 871.8407, 5e-5);
  EXPECT_DOUBLE_EQ(KinematicFlow::streamline(x0, z0, z1), 3);
  constexpr int steps = 2000;
  constexpr double dz = (z0 - z1) / steps;
  const auto slowness = [&](double z) { return 1 / unit.downward(KinematicFlow::streamline(x0, z0, z), z); };
  double time = 0;
  for (int k = 0; k < steps; ++k) {
    const double z = z1 + k * dz;
    time += dz / 6 * (slowness(z) + 4 * slowness(z + dz / 2) + slowness(z + dz));
    const double x = KinematicFlow::streamline(x0, z0, z + dz / 2);
    const double slope = (KinematicFlow::streamline(x0, z0, z + dz) - KinematicFlow::streamline(x0, z0, z)) / dz;
    EXPECT_NEAR(slope, -unit.sideways(x, z + dz / 2) / unit.downward(x, z + dz / 2), 1e-6);
  }
  EXPECT_NEAR(time, unit.residence(x0, z0, z1), 1e-9 * time);
}

// -∂P/∂z = b ∂²P/∂x² - 2b ∂/∂x(P ∂ log v/∂x), the errors of differences as above, P < 0.3.
TEST(VoidModel, SolvesItsEquation) {
  constexpr VoidModel voids{2.28};
  constexpr double x0 = 9, z0 = 50;
  for (double z : {10.0, 25.0, 40.0})
    for (double x : {0.0, 4.0, 9.0}) {
      const auto p = [&](double at_x, double at_z) { return voids.probability(x0, z0, at_x, at_z); };
      const auto drift_flux = [&](double at) { return p(at, z) * VoidModel::drift(at, z); };
      const double gain =
          voids.diffusivity() * second(p(x - h, z), p(x, z), p(x + h, z)) - first(drift_flux(x - h), drift_flux(x + h));
      EXPECT_NEAR(-first(p(x, z - h), p(x, z + h)), gain, 5e-8);
      // The drift is twice the slope of the logarithm of the kinematic flow.
      const double log_slope = first(std::log(flow.downward(x - h, z)), std::log(flow.downward(x + h, z)));
      EXPECT_NEAR(VoidModel::drift(x, z), 2 * flow.b * log_slope, 1e-8);
    }
}

TEST(VoidModel, GrainsSpreadAndGatherAgain) {
  constexpr VoidModel voids{2.28};
  EXPECT_DOUBLE_EQ(VoidModel::mean(9, 50, 10), 1.8);
  EXPECT_DOUBLE_EQ(voids.variance(50, 25), 2 * 2.28 * 25 * 0.5);  // the most
  EXPECT_DOUBLE_EQ(voids.variance(50, 50), 0);
  double sum = 0;
  double mean = 0;
  double square = 0;
  for (double x = -100; x <= 100; x += 0.25) {
    const double p = 0.25 * voids.probability(9, 50, x, 20);
    sum += p;
    mean += p * x;
    square += p * x * x;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_NEAR(mean, VoidModel::mean(9, 50, 20), 1e-10);
  EXPECT_NEAR(square - mean * mean, voids.variance(50, 20), 1e-9);
}

}  // namespace
}  // namespace grainvdb::kinematic_test
