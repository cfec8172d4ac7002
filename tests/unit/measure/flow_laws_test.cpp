/// What is measured of a state: balance, regimes, scalings and kinetic theory.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/laws.hpp"
#include "measure/balance.hpp"
#include "measure/regime.hpp"

namespace grainvdb::flow_laws_test {
namespace {

using ::testing::HasSubstr;

/// Simple shear at a rate γ under the pressure p.
FlowState sheared(double phi, double rate, double pressure, double temperature) {
  FlowState s;
  s.phi = phi;
  s.density = 2500 * phi;
  s.diameter = 1e-3;
  s.temperature = temperature;
  s.gradient = {0, 0, rate, 0, 0, 0, 0, 0, 0};
  s.stress = {-pressure, 0, 0.3 * pressure, 0, -pressure, 0, 0.3 * pressure, 0, -pressure};
  return s;
}

TEST(Scalings, BagnoldPressureDoesNotDependOnTheRate) {
  // P = 40 ρ_p d² γ̇².
  for (const double rate : {1.0, 10.0, 250.0}) {
    const FlowState s = sheared(0.55, rate, 40 * 2500 * 1e-6 * rate * rate, 1);
    EXPECT_NEAR(bagnold_pressure(s), 40, 1e-12 * 40);
    EXPECT_NEAR(bagnold_pressure(s) * s.inertial_number() * s.inertial_number(), 1, 1e-12);
  }
  EXPECT_TRUE(std::isnan(bagnold_pressure(sheared(0.55, 0, 100, 1))));
}

TEST(Scalings, SoftNumbersAreThoseOfTheStiffness) {
  const FlowState s = sheared(0.6, 20, 300, 1);
  EXPECT_DOUBLE_EQ(soft_pressure(s, 2e4), 300 * 1e-3 / 2e4);
  EXPECT_DOUBLE_EQ(soft_rate(s, 2e4), 20 * std::sqrt(2500e-9 / 2e4));
}

TEST(RegimeBounds, PartTheInertialNumbers) {
  const RegimeBounds bounds;
  EXPECT_EQ(bounds(9e-4), Regime::quasi_static);
  EXPECT_EQ(bounds(1e-3), Regime::intermediate);
  EXPECT_EQ(bounds(0.1), Regime::intermediate);
  EXPECT_EQ(bounds(0.11), Regime::inertial);
}

// Physics section 4, e = 0.7, to the four digits given there; valid up to ν = 0.5 only.
TEST(KineticPrediction, SteadyShearHasThePublishedPressures) {
  const double nu[] = {.1, .2, .3, .4, .5}, p[] = {.3690, .3011, .4191, .7512, 1.5591};
  for (int n = 0; n < 5; ++n)
    EXPECT_NEAR(kinetic_prediction(sheared(nu[n], 10, 100, 1), .7, .5).steady_pressure, p[n], .5e-4);
  EXPECT_TRUE(std::isnan(kinetic_prediction(sheared(.51, 10, 100, 1), .7, .5).steady_pressure));
  EXPECT_TRUE(std::isnan(kinetic_prediction(sheared(.51, 10, 100, 1), .7, .5).pressure));
  EXPECT_TRUE(std::isnan(kinetic_prediction(sheared(0, 10, 100, 1), .7, .5).mu));
}

// At the temperature that steady shear keeps, T_kin = (f₂/f₃) d² γ̇² (T = 3 T_kin), both predictions are one, and
// μ = τ/p = Γ/(γ̇ p).
TEST(KineticPrediction, MeasuredTemperatureIsASumOverComponents) {
  const KineticTheory theory(.7);
  const double nu = .3, rate = 50;
  const double kinetic = theory.f2(nu) / theory.f3(nu) * std::pow(1e-3 * rate, 2);
  const KineticPrediction found = kinetic_prediction(sheared(nu, rate, 100, 3 * kinetic), .7, .5);
  EXPECT_NEAR(found.pressure, found.steady_pressure, 1e-12);
  EXPECT_NEAR(found.mu, theory.f3(nu) * std::sqrt(kinetic) / (theory.f1(nu) * 1e-3 * rate), 1e-12);
}

/// A layer of density 1500 between 1 and 2 under 300 Pa and gravity.
LayerProfile layer(double gravity, double shear_slope) {
  LayerProfile all;
  for (int n = 0; n <= 10; ++n) {
    all.z.push_back(1 + 0.1 * n);
    all.shear.push_back(120 + shear_slope * (all.z.back() - 1.5));
    all.density.push_back(1500);
    all.normal.push_back(-300 - 1500 * gravity * (2 - all.z.back()));
  }
  return all;
}

TEST(Balance, SteadyLayerIsInBalance) {
  const Balance b = balance_of(layer(9.81, 0), 9.81);
  EXPECT_NEAR(b.shear, 120, 1e-11);
  EXPECT_NEAR(b.shear_change, 0, 1e-13);
  EXPECT_NEAR(b.gravity, 9.81, 1e-11);
  EXPECT_NEAR(b.residual, 0, 1e-13);
  const Balance weightless = balance_of(layer(0, 0), 0);
  EXPECT_NEAR(weightless.normal_change, 0, 1e-13);
  EXPECT_NEAR(weightless.gravity, 0, 1e-12);
}

TEST(Balance, ShowsWhatIsOutOfBalance) {
  EXPECT_NEAR(balance_of(layer(9.81, 12), 9.81).shear_change, 0.1, 1e-12);
  // With half the gravity the rest, 1500·4.905 (z - mean), is left: its mean square over 11 planes is 0.1.
  const double left = 1500 * 4.905 * std::sqrt(0.1);
  EXPECT_NEAR(balance_of(layer(9.81, 0), 4.905).residual, left / (300 + 1500 * 9.81 * 0.5), 1e-12);
}

TEST(Balance, IntegralOfALineIsExact) {
  const std::vector<double> sum = integral({0, 1, 3}, {0, 1, 3});
  EXPECT_EQ(sum, (std::vector<double>{0, 0.5, 4.5}));
}

TEST(Drift, IsTheSlopeWithItsError) {
  // Residuals (1, -2, 1)/10 about 4 + 2 (t - 1).
  const Fit fit = fit_drift({0, 1, 2}, {2.1, 3.8, 6.1});
  ASSERT_TRUE(fit.fitted()) << fit.refusal;
  EXPECT_NEAR(fit.parameters[0], 4, 1e-12);
  EXPECT_NEAR(fit.parameters[1], 2, 1e-12);
  EXPECT_NEAR(fit.errors[1], std::sqrt(0.06 / 2), 1e-12);
  EXPECT_THAT(fit_drift({0, 1}, {1, 2}).refusal, HasSubstr("2 observations"));
  EXPECT_THAT(fit_drift({}, {}).refusal, HasSubstr("0 observations"));
}

}  // namespace
}  // namespace grainvdb::flow_laws_test
