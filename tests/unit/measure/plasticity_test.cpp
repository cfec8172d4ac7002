// Incipient yield, coaxiality, collapse and the stochastic flow rule on fields that are known.
#include "measure/plasticity.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "unit/measure/field_scene.hpp"

namespace grainvdb::testing::plasticity_test {
namespace {

constexpr double pi = std::numbers::pi;
const Lattice lattice(0.5, {0, 0, 0});

std::shared_ptr<const Topology> cube(std::int32_t n) {
  return voxels_between({0, 0, 0}, {n - 1, n - 1, n - 1});
}

/// Principal stresses -1, -2 and -4 everywhere: μ_MC = 3/(2·2), deviators -4/7, -1/7 and 5/7 of P = 7/3.
FieldScene yielding(const std::shared_ptr<const Topology>& topology, const OptionValues& options = {}) {
  FieldScene s(incipient_yield_measurement(), lattice, topology, options);
  s.set("phi", 0.6);
  s.set("shear_rate", 2);
  s.set("mu_mohr_coulomb", 0.75);
  s.set("principal_stress", 3, [](const Vec3&, int k) { return k == 0 ? -1 : k == 1 ? -2 : -4; });
  return s;
}

TEST(IncipientYield, OneRatioEverywhereHasNoSpread) {
  const std::vector<Table> tables = yielding(cube(8)).tables();
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name, "incipient_yield");
  EXPECT_DOUBLE_EQ(number(tables[0], "mean").value, 0.75);
  EXPECT_NEAR(number(tables[0], "spread").value, 0, 1e-12);
  EXPECT_NEAR(number(tables[0], "relative_spread").value, 0, 1e-12);
  EXPECT_DOUBLE_EQ(number(tables[0], "quantile_5").value, 0.75);
  EXPECT_NEAR(number(tables[0], "undefined_share").value, 0, 1e-12);
  const std::vector<double>& density = column(tables[0], "density");
  ASSERT_EQ(density.size(), 40U);  // of width 0.05
  EXPECT_NEAR(density[15], 20, 1e-9);

  // P is taken off; stored as float, 2⁻²⁴ relative.
  const char* const names[] = {"least", "middle", "most"};
  const double deviators[] = {-4.0 / 7, -1.0 / 7, 5.0 / 7};
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(number(tables[1], names[k] + std::string("_mean")).value, deviators[k], 1e-6);
}

// Half the voxels have ratio 0.5, the others 1; of the latter twice as many by φ, and they shear at three times the
// rate.
TEST(IncipientYield, WeightsByPhiOrByShearRate) {
  const auto halves = [](FieldScene s) {
    const auto upper = [](const Vec3& x) { return x[0] > 2; };
    s.set("mu_mohr_coulomb", 1, [=](const Vec3& x, int) { return upper(x) ? 1 : 0.5; });
    s.set("phi", 1, [=](const Vec3& x, int) { return upper(x) ? 0.6 : 0.3125; });
    s.set("shear_rate", 1, [=](const Vec3& x, int) { return upper(x) ? 3 : 1; });
    return s.tables()[0];
  };
  const float phi = 0.6F;
  EXPECT_NEAR(number(halves(yielding(cube(8))), "mean").value, (0.3125 * 0.5 + phi) / (0.3125 + phi), 1e-12);
  const Table by_rate = halves(yielding(cube(8), {{"weight", std::string("shear_rate")}}));
  EXPECT_NEAR(number(by_rate, "mean").value, (0.5 + 3) / 4, 1e-12);
  const Table dense = halves(yielding(cube(8), {{"phi_min", 0.5}}));
  EXPECT_NEAR(number(dense, "mean").value, 1, 1e-12);
}

TEST(IncipientYield, CountsWhatIsUndefinedOrBeyondTheHistogram) {
  FieldScene s = yielding(cube(8));
  s.set("mu_mohr_coulomb", 1, [](const Vec3& x, int) { return x[0] < 1 ? std::nan("") : x[0] < 2 ? 5 : 0.5; });
  const Table t = s.tables()[0];
  EXPECT_NEAR(number(t, "undefined_share").value, 0.25, 1e-12);
  EXPECT_NEAR(number(t, "outside_share").value, 1 / 3.0, 1e-12);
  s.set("mu_mohr_coulomb", std::nan(""));
  EXPECT_EQ(s.tables()[0].remarks.size(), 1U);
  EXPECT_TRUE(std::isnan(number(s.tables()[0], "mean").value));
}

FieldScene turned(const std::function<double(const Vec3&)>& angle, const std::function<double(const Vec3&)>& rate) {
  FieldScene s(coaxiality_measurement(), lattice, cube(16));
  s.set("phi", 0.6);
  s.set("coaxiality_angle", 1, [=](const Vec3& x, int) { return angle(x); });
  s.set("shear_rate", 1, [=](const Vec3& x, int) { return rate(x); });
  return s;
}

TEST(Coaxiality, OfAlignedAndOfTurnedAxes) {
  const auto one = [](const Vec3&) { return 1.0; };
  const Table aligned = turned([](const Vec3&) { return 0.0; }, one).tables()[0];
  EXPECT_EQ(number(aligned, "mean").value, 0);
  EXPECT_NEAR(column(aligned, "density")[0], 18 / (pi / 2), 1e-9);
  const Table turned_by_45 = turned([](const Vec3&) { return pi / 4; }, one).tables()[0];
  EXPECT_NEAR(number(turned_by_45, "mean").value, pi / 4, 1e-7);
  EXPECT_NEAR(number(turned_by_45, "spread").value, 0, 1e-7);

  // Where nothing flows, nothing counts; what flows three times as fast counts three times.
  const Table weighted = turned([](const Vec3& x) { return x[0] < 2   ? 0.25
                                                           : x[0] < 4 ? 0.5
                                                                      : 1; },
                                [](const Vec3& x) { return x[0] < 2   ? 1
                                                           : x[0] < 4 ? 3
                                                                      : 0; })
                             .tables()[0];
  EXPECT_NEAR(number(weighted, "mean").value, (0.25 + 3 * 0.5) / 4, 1e-12);
}

// The density of angles between axes without relation integrates to 1, with mean 1.
TEST(Coaxiality, RandomAxesAreTheComparison) {
  const Table t = turned([](const Vec3&) { return 0.0; }, [](const Vec3&) { return 1.0; }).tables()[0];
  const std::vector<double>& random = column(t, "random");
  double sum = 0;
  double mean = 0;
  const double width = pi / 2 / static_cast<double>(random.size());
  for (std::size_t k = 0; k < random.size(); ++k) {
    sum += random[k] * width;
    mean += random[k] * width * column(t, "angle")[k];
  }
  EXPECT_NEAR(sum, 1, 1e-14);
  EXPECT_NEAR(mean, 1 - width * width / 12, 1e-6);  // of the middles of bins; the next order is width⁴
}

FieldScene on_phi(const std::function<double(double phi, const Vec3&)>& law) {
  FieldScene s(collapse_measurement(), lattice, cube(16), {{"of", std::vector<std::string>{"shear_rate"}}});
  const auto phi = [](const Vec3& x) { return 0.5 + 0.0125 * x[0]; };  // 16 values, 0.00625 apart
  s.set("phi", 1, [=](const Vec3& x, int) { return phi(x); });
  s.set("shear_rate", 1, [=](const Vec3& x, int) { return law(phi(x), x); });
  return s;
}

TEST(Collapse, ALawGivesOne) {
  const Table t = on_phi([](double phi, const Vec3&) { return std::exp(-50 * (phi - 0.5)); }).tables()[0];
  EXPECT_EQ(t.name, "collapse_shear_rate");
  EXPECT_NEAR(number(t, "collapse").value, 1, 1e-12);
  EXPECT_NEAR(number(t, "collapse_log").value, 1, 1e-12);
  ASSERT_EQ(column(t, "phi").size(), 16U);
  for (double points : column(t, "points")) EXPECT_EQ(points, 256);
  EXPECT_TRUE(t.columns[1].dimension == dimension::rate);
}

// What differs along y alone: the same in all bins, so that nothing is told; what the bins cost in degrees of freedom
// leaves 1 - (n-1)/(n-B), n = 4096 and B = 16.
TEST(Collapse, WhatPhiDoesNotTellGivesNothing) {
  const Table t = on_phi([](double, const Vec3& x) { return x[1]; }).tables()[0];
  EXPECT_NEAR(number(t, "collapse").value, 1 - 4095.0 / 4080, 1e-9);
  EXPECT_NEAR(number(t, "collapse").error, std::sqrt(2 * 15.0 / (4080.0 * 4097)), 1e-12);
}

TEST(Collapse, AsksForNothingElse) {
  EXPECT_EQ(on_phi([](double, const Vec3&) { return 1.0; }).needs().fields,
            (std::vector<std::string>{"phi", "shear_rate"}));
  EXPECT_FALSE(on_phi([](double, const Vec3&) { return 1.0; }).needs().particles.has_value());
}

FieldScene drifting(const Vec3& drift, const Vec3& velocity, const OptionValues& options = {}) {
  FieldScene s(stochastic_flow_rule_measurement(), lattice, cube(24), options);
  s.set("phi", 0.6);
  s.set("spot_drift", 3, [=](const Vec3&, int k) { return drift[static_cast<std::size_t>(k)]; });
  s.set("velocity", 3, [=](const Vec3&, int k) { return velocity[static_cast<std::size_t>(k)]; });
  return s;
}

TEST(StochasticFlowRule, AngleFromTheWayAgainstTheDrift) {
  const auto mean = [](const Vec3& drift, const Vec3& velocity) {
    return number(drifting(drift, velocity).tables().at(0), "mean").value;
  };
  EXPECT_NEAR(mean({0, 0, 3}, {0, 0, -1}), 0, 1e-12);
  EXPECT_NEAR(mean({0, 0, 3}, {0, 0, 1}), pi, 1e-12);
  EXPECT_NEAR(mean({3, 0, 3}, {0, 0, -1}), pi / 4, 1e-7);
  EXPECT_TRUE(std::isnan(mean({0, 0, 3}, {0, 0, 0})));
}

TEST(StochasticFlowRule, DrawsLinesFromWhereTheyAreWanted) {
  const OptionValues options{{"from", std::vector<double>{1, 1, 1}},
                             {"to", std::vector<double>{3, 1, 1}},
                             {"lines", std::int64_t{3}},
                             {"length", 4.0}};
  const std::vector<Table> tables = drifting({0, 0, 3}, {0, 0, -1}, options).tables();
  ASSERT_EQ(tables.size(), 2U);
  const Table& t = tables[1];
  ASSERT_EQ(t.columns[0].values.size(), 3U * 17);  // steps of h/2 over 4, ends included
  for (std::size_t n = 0; n < t.columns[0].values.size(); ++n) {
    EXPECT_NEAR(column(t, "x")[n], 1 + column(t, "line")[n], 1e-12);
    EXPECT_NEAR(column(t, "z")[n], 1 + column(t, "way")[n], 1e-5);
  }
  EXPECT_EQ(drifting({0, 0, 3}, {0, 0, -1}).tables().size(), 1U);
}

TEST(StochasticFlowRule, RefusesPlacesThatAreNone) {
  const MeasurementInfo info = stochastic_flow_rule_measurement();
  const auto refused = [&](std::vector<double> from, std::vector<double> to) {
    return info.conflict({{"from", std::move(from)}, {"to", std::move(to)}}).has_value();
  };
  EXPECT_FALSE(refused({}, {}));
  EXPECT_FALSE(refused({1, 2, 3}, {1, 2, 4}));
  EXPECT_TRUE(refused({1, 2}, {1, 2}));
  EXPECT_TRUE(refused({1, 2, 3}, {}));
}

}  // namespace
}  // namespace grainvdb::testing::plasticity_test
