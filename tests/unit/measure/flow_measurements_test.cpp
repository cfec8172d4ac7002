/// The measurements of fluidity, rheology and stationarity on fields that follow the laws they fit.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/laws.hpp"
#include "measure/register.hpp"
#include "unit/measure/synthetic.hpp"

namespace grainvdb::flow_measurements_test {
namespace {

using testing::column_of;
using ::testing::HasSubstr;
using testing::number_of;
using testing::scalar;
using testing::SyntheticField;

const Lattice lattice(0.001, {0, 0, 0});
constexpr int planes = 60;
const StageSettings stages{{"gd_over_dv", {{"temperature_min", 0.0}}}, {"velocity", {{"resolution", 0.0}}}};

/// A flow along x sheared along z, whose state is a function of the number of the plane.
struct ShearFlow {
  std::function<double(double)> phi, rate, pressure, mu, temperature;

  OutputFields output(double noise = 0) const {
    const auto plane = [](const Vec3& x) { return x[2] / 0.001 - 0.5; };
    return testing::synthetic_output(
        lattice, {0, 0, 0}, {1, 1, planes - 1},
        {scalar("phi", [=, this](const Vec3& x) { return phi(plane(x)); }),
         scalar("density", [=, this](const Vec3& x) { return 2500 * phi(plane(x)); }),
         scalar("mean_diameter", [](const Vec3&) { return 8e-4; }),
         scalar("temperature", [=, this](const Vec3& x) { return temperature(plane(x)); }),
         scalar("pressure_floor", [](const Vec3&) { return 0; }),
         scalar("rotational_fluctuation", [](const Vec3&) { return 10000; }),
         {"velocity", 3, [](const Vec3&, std::span<double> out) { out[0] = out[1] = out[2] = 0; }},
         {"velocity_gradient", 9,
          [=, this](const Vec3& x, std::span<double> out) {
            std::fill(out.begin(), out.end(), 0.0);
            out[2] = rate(plane(x)) * (1 + noise);
          }},
         {"stress", 9, [=, this](const Vec3& x, std::span<double> out) {
            std::fill(out.begin(), out.end(), 0.0);
            const double p = pressure(plane(x));
            out[0] = out[4] = out[8] = -p;
            out[2] = out[6] = mu(plane(x)) * p;
          }}});
  }
};

std::vector<Table> measured(const MeasurementInfo& info, const OptionValues& options,
                            const std::vector<OutputFields>& outputs, const std::vector<Frame>& frames = {}) {
  const auto measurement = info.make({options, stages, lattice, LucyKernel(0.0024), Box{}, {}});
  for (const Frame& frame : frames) measurement->add(frame);
  for (const OutputFields& output : outputs) measurement->take(output);
  return measurement->tables();
}

ShearFlow fluid_flow(const FluidityLaw& law, double from, double to) {
  ShearFlow flow;
  flow.phi = [=](double n) { return from + (to - from) * n / (planes - 1); };
  flow.rate = [](double) { return 20; };
  flow.pressure = [](double) { return 300; };
  flow.mu = [](double) { return 0.4; };
  // g d/√T = F(φ) with g = 20/0.4.
  flow.temperature = [=, phi = flow.phi](double n) { return std::pow(20 / 0.4 * 8e-4 / law(phi(n)), 2); };
  return flow;
}

// Fields are floats: φ is rounded by 3e-8 and F by 53 times that, about 2e-6; the condition number lets the parameters
// follow by some 50 times as much.
TEST(FluidityMeasurement, RecoversTheLawOfItsFields) {
  const MeasurementInfo info = fluidity_measurements().front();
  const FluidityLaw law = fluidity_fits[3].law;
  for (const char* source : {"profile", "voxels"}) {
    OptionValues options = testing::defaults_of(info);
    options["source"] = std::string(source);
    options["compare"] = std::string("mu_p = 0.4");
    std::vector<OutputFields> outputs;
    outputs.push_back(fluid_flow(law, 0.52, 0.618).output());
    const Table table = measured(info, options, outputs).front();
    EXPECT_NEAR(number_of(table, "A").value, law.a, 1e-4 * law.a) << source;
    EXPECT_NEAR(number_of(table, "B").value, law.b, 1e-4 * law.b);
    EXPECT_NEAR(number_of(table, "C").value, law.c, 1e-3 * law.c);
    EXPECT_NEAR(number_of(table, "D").value, law.d, 1e-3 * law.d);
    EXPECT_EQ(number_of(table, "D_reference").value, 0.0377);
    EXPECT_NEAR(number_of(table, "deviation").value, 0, 1e-4);
    EXPECT_EQ(column_of(table, "phi").size(), source == std::string("voxels") ? 4U * planes : 1U * planes);
    for (std::size_t n = 0; n < column_of(table, "phi").size(); ++n) {
      EXPECT_NEAR(column_of(table, "fit")[n], column_of(table, "gd_over_dv")[n], 1e-4);
      EXPECT_EQ(column_of(table, "law_3")[n], zhang_kamrin_law(column_of(table, "phi")[n]));
    }
  }
}

// (A24) and (A25) with g = 20/0.4 and δω = 100.
TEST(FluidityMeasurement, TellsTheRatiosToTheSpin) {
  const MeasurementInfo info = fluidity_measurements().front();
  OptionValues options = testing::defaults_of(info);
  EXPECT_THAT(info.needs(options).fields, ::testing::Not(::testing::Contains("rotational_fluctuation")));
  options["spin"] = true;
  EXPECT_THAT(info.needs(options).fields, ::testing::Contains("rotational_fluctuation"));
  const ShearFlow flow = fluid_flow(fluidity_fits[3].law, 0.52, 0.60);
  std::vector<OutputFields> outputs;
  outputs.push_back(flow.output());
  const Table table = measured(info, options, outputs).front();
  for (std::size_t n = 0; n < planes; ++n) {
    EXPECT_NEAR(column_of(table, "g_over_domega")[n], 0.5, 1e-6);
    const double dv_over_d_domega = std::sqrt(flow.temperature(static_cast<double>(n))) / (8e-4 * 100);
    EXPECT_NEAR(column_of(table, "dv_over_d_domega")[n], dv_over_d_domega, 1e-6 * dv_over_d_domega);
  }
}

TEST(FluidityMeasurement, RefusesAPlateauInWords) {
  const MeasurementInfo info = fluidity_measurements().front();
  std::vector<OutputFields> outputs;
  outputs.push_back(fluid_flow(fluidity_fits[3].law, 0.50, 0.54).output());
  const Table table = measured(info, testing::defaults_of(info), outputs).front();
  EXPECT_TRUE(std::isnan(number_of(table, "A").value));
  EXPECT_THAT(table.remarks, ::testing::Contains(HasSubstr("A fit of A, B, C and D is refused")));
  EXPECT_THAT(table.remarks, ::testing::Contains(HasSubstr("A fit of A, B and D with C held is refused")));
}

// Two output times whose rates differ by ±1 %: g d/δv as well, and the jackknife gives 1 % of it.
TEST(FluidityMeasurement, ErrorsAreThoseOverOutputTimes) {
  const MeasurementInfo info = fluidity_measurements().front();
  const ShearFlow flow = fluid_flow(fluidity_fits[3].law, 0.52, 0.60);
  std::vector<OutputFields> outputs;
  outputs.push_back(flow.output(0.01));
  outputs.push_back(flow.output(-0.01));
  const Table table = measured(info, testing::defaults_of(info), outputs).front();
  for (std::size_t n = 0; n < planes; ++n)
    EXPECT_NEAR(column_of(table, "gd_over_dv_error")[n], 0.01 * column_of(table, "gd_over_dv")[n], 1e-5);
}

// Octave makes variables of what a file names, and others where these are no names.
constexpr const char* variable_name = "[A-Za-z_][A-Za-z0-9_]*";

TEST(RheologyMeasurement, RecoversItsLaws) {
  const MeasurementInfo info = rheology_measurements().front();
  const FrictionLaw mu;
  const PackingLaw nu;
  const auto inertial = [](double n) { return 1e-3 * std::pow(1000, n / (planes - 1)); };
  ShearFlow flow;
  flow.pressure = [](double) { return 300; };
  flow.rate = [=](double n) { return inertial(n) / 8e-4 * std::sqrt(300 / 2500.0); };
  flow.mu = [=](double n) { return mu(inertial(n)); };
  flow.phi = [=](double n) { return nu(inertial(n), 0); };
  flow.temperature = [](double) { return 1e-3; };
  std::vector<OutputFields> outputs;
  outputs.push_back(flow.output());
  OptionValues options = testing::defaults_of(info);
  options["rate_fraction"] = 2e-3;
  const Table table = measured(info, options, outputs).front();
  // Rounding of floats, 6e-8, times condition numbers below 1000.
  EXPECT_NEAR(number_of(table, "mu_0").value, mu.mu_0, 1e-4);
  EXPECT_NEAR(number_of(table, "mu_infinity").value, mu.mu_infinity, 1e-4);
  EXPECT_NEAR(number_of(table, "I_0").value, mu.i_0, 1e-4);
  EXPECT_NEAR(number_of(table, "nu_c").value, nu.nu_c, 1e-4);
  EXPECT_NEAR(number_of(table, "I_c").value, nu.i_c, 1e-3);
  for (std::size_t n = 0; n < planes; ++n) {
    const double i = column_of(table, "inertial_number")[n];
    EXPECT_NEAR(i, inertial(static_cast<double>(n)), 1e-6 * i);
    EXPECT_NEAR(column_of(table, "bagnold_pressure")[n] * i * i, 1, 1e-6);
    EXPECT_EQ(column_of(table, "regime")[n], i < 1e-3 ? 0 : i > 0.1 ? 2 : 1);
    EXPECT_EQ(column_of(table, "in_band")[n], i >= 2e-3 ? 1 : 0);
    EXPECT_EQ(std::isnan(column_of(table, "skt_pressure")[n]), column_of(table, "phi")[n] > 0.5);
    EXPECT_TRUE(std::isnan(column_of(table, "p_star")[n]));
  }
  EXPECT_THAT(table.remarks, ::testing::Contains(HasSubstr("Kinetic theory is not compared")));
  for (const TableColumn& column : table.columns) EXPECT_THAT(column.name, ::testing::MatchesRegex(variable_name));
  for (const Quantity& number : table.numbers) EXPECT_THAT(number.name, ::testing::MatchesRegex(variable_name));
}

TEST(RheologyMeasurement, RefusesSlowFlowAlone) {
  const MeasurementInfo info = rheology_measurements().front();
  ShearFlow flow = fluid_flow(fluidity_fits[3].law, 0.55, 0.55);
  flow.rate = [](double n) { return 1e-4 * (1 + n); };
  std::vector<OutputFields> outputs;
  outputs.push_back(flow.output());
  const Table table = measured(info, testing::defaults_of(info), outputs).front();
  EXPECT_TRUE(std::isnan(number_of(table, "mu_0").value));
  EXPECT_THAT(table.remarks, ::testing::Contains(HasSubstr("A fit of mu(I) is refused")));
  EXPECT_THAT(table.remarks, ::testing::Contains(HasSubstr("A fit of nu(I) is refused")));
}

TEST(StationarityMeasurement, FindsGravityAndDrift) {
  const MeasurementInfo info = stationarity_measurements().front();
  OptionValues options = testing::defaults_of(info);
  options["gravity"] = 9.81;
  ShearFlow flow = fluid_flow(fluidity_fits[3].law, 0.6, 0.6);
  flow.pressure = [](double n) { return 300 + 1500 * 9.81 * 0.001 * (planes - n); };
  flow.mu = [pressure = flow.pressure](double n) { return 120 / pressure(n); };
  std::vector<OutputFields> outputs;
  outputs.push_back(flow.output());
  outputs.push_back(flow.output());
  std::vector<Frame> frames(4);
  for (int n = 0; n < 4; ++n) {
    Frame& frame = frames[static_cast<std::size_t>(n)];
    frame.time = 0.5 * n;
    frame.particles.id = {1, 2};
    frame.particles.mass = {1, 3};
    // e = (m v² of both)/2 over 4: (2 + 3 (4 + 2t))/8.
    frame.particles.velocity = {std::vector<double>{0, 0}, {std::sqrt(2), std::sqrt(4 + 1.0 * n)}, {0, 0}};
  }
  const std::vector<Table> tables = measured(info, options, outputs, frames);
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_NEAR(number_of(tables[0], "gravity").value, 9.81, 1e-4);
  EXPECT_NEAR(number_of(tables[0], "gravity").error, 0, 1e-9);
  EXPECT_NEAR(number_of(tables[0], "mean_shear").value, 120, 1e-4);
  EXPECT_NEAR(number_of(tables[0], "shear_change").value, 0, 1e-6);
  EXPECT_NEAR(number_of(tables[0], "balance_residual").value, 0, 1e-6);
  EXPECT_EQ(column_of(tables[0], "balanced").size(), column_of(tables[0], "z").size());
  EXPECT_NEAR(number_of(tables[1], "drift").value, 6.0 / 8, 1e-12);
  EXPECT_NEAR(number_of(tables[1], "energy").value, (2 + 3 * 5.5) / 8, 1e-12);
}

}  // namespace
}  // namespace grainvdb::flow_measurements_test
