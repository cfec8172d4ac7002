// The mean-field theory of spots beside a flow that it makes.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"
#include "measure/plasticity.hpp"
#include "unit/measure/field_scene.hpp"

namespace grainvdb::testing::mean_field_test {
namespace {

const Lattice lattice(0.5, {0, 0, 0});
const KinematicFlow flow{2.28, 1.7};

/// The kinematic flow down from a slot at x = 4, z = -2; along y it goes up, which is no part of the plane.
FieldScene draining(const OptionValues& options) {
  OptionValues all{{"slot", 4.0}, {"bottom", -2.0}, {"radius", 2.6}};
  for (const auto& [name, value] : options) all[name] = value;
  FieldScene s(mean_field_measurement(), lattice, voxels_between({-80, 0, 0}, {96, 1, 20}), all);
  s.set("phi", 0.6);
  s.set("velocity", 3, [](const Vec3& x, int k) {
    const double across = x[0] - 4, up = x[2] + 2;
    return k == 0 ? flow.sideways(across, up) : k == 1 ? 9 : -flow.downward(across, up);
  });
  return s;
}

// Where spots reach no distance the theory is the kinematic flow: u = b ∂v/∂x with spots asked halfway along their
// step, twice that at its end. Velocities are floats, and b of 2000 of them is good to 1e-6.
TEST(MeanFieldMeasurement, IsTheKinematicFlowForSmallSpots) {
  const Table t = draining({{"radius", 0.01}, {"influence", 0.01}}).tables().at(0);
  EXPECT_EQ(t.name, "mean_field");
  EXPECT_TRUE(t.remarks.empty());
  for (std::size_t n = 0; n < column(t, "x").size(); ++n) {
    const double x = column(t, "x")[n], z = column(t, "z")[n];
    EXPECT_GE(z, 3);  // the kernel's cutoff
    EXPECT_NEAR(column(t, "velocity")[n], flow.downward(x, z), 1e-7);
    EXPECT_NEAR(column(t, "drift")[n], flow.downward(x, z), 2e-6);
    EXPECT_NEAR(column(t, "sideways")[n], flow.sideways(x, z), 1e-7);
    EXPECT_NEAR(column(t, "drift_sideways")[n], flow.sideways(x, z), 2e-6);
    EXPECT_NEAR(column(t, "diffusivity")[n], 0.01 * flow.b * flow.downward(x, z), 1e-7);
  }
  EXPECT_NEAR(number(t, "velocity_over_drift").value, 1, 1e-5);
  EXPECT_NEAR(number(t, "sideways_over_drift").value, 1, 1e-5);
  EXPECT_NEAR(number(t, "grain_diffusion").value, 0.01 * 2.28, 1e-6);
  const Table at_end = draining({{"radius", 0.01}, {"place", 1.0}}).tables().at(0);
  EXPECT_NEAR(number(at_end, "sideways_over_drift").value, 0.5, 1e-5);
  EXPECT_NEAR(number(at_end, "velocity_over_drift").value, 1, 1e-5);
}

// Spots that lie nearer together than the flow by R²/5 make one of its width. Their mean over the ball is no Gaussian
// any more, but its sum over x and its second moment are those of the flow.
TEST(MeanFieldMeasurement, MakesTheFluxAndTheWidthOfTheFlow) {
  const Table t = draining({}).tables().at(0);
  EXPECT_NEAR(number(t, "spot_rise").value, -2.6 * 2.6 / (10 * 2.28), 1e-5);
  for (const double z : {8.25, 11.75}) {
    double sum = 0, square = 0;
    for (std::size_t n = 0; n < column(t, "x").size(); ++n) {
      if (column(t, "z")[n] != z) continue;
      sum += 0.5 * column(t, "drift")[n];
      square += 0.5 * column(t, "drift")[n] * std::pow(column(t, "x")[n], 2);
    }
    EXPECT_NEAR(sum, flow.discharge, 1e-5);
    EXPECT_NEAR(square / sum, flow.variance(z), 1e-3);
  }
}

TEST(MeanFieldMeasurement, TakesBAndDischargeThatAreGiven) {
  const Table t = draining({{"radius", 0.01}, {"b", 1.14}, {"discharge", 3.4}}).tables().at(0);
  EXPECT_EQ(number(t, "b").value, 1.14);
  EXPECT_TRUE(std::isnan(number(t, "b").error));
  EXPECT_EQ(number(t, "spot_rise").value, 0);
  const KinematicFlow given{1.14, 3.4};
  double squares = 0;
  for (std::size_t n = 0; n < column(t, "x").size(); ++n) {
    const double x = column(t, "x")[n], z = column(t, "z")[n];
    EXPECT_NEAR(column(t, "drift")[n], given.downward(x, z), 1e-6);
    squares += std::pow(flow.downward(x, z) - given.downward(x, z), 2);
  }
  const auto places = static_cast<double>(column(t, "x").size());
  EXPECT_NEAR(number(t, "rms").value, std::sqrt(squares / places), 1e-6);
}

// A flow that is twice the theory: ratios of 2, with no error but rounding; with noise the error covers it.
TEST(MeanFieldMeasurement, ErrorsOfRatiosCoverTheNoise) {
  FieldScene s = draining({{"radius", 0.01}, {"b", 2.28}, {"discharge", 0.85}, {"half_width", 6.0}});
  const Table exact = s.tables().at(0);
  EXPECT_NEAR(number(exact, "velocity_over_drift").value, 2, 1e-5);
  EXPECT_LT(number(exact, "velocity_over_drift").error, 1e-5);
  s.set("velocity", 3, [](const Vec3& x, int k) {
    const double noise = 0.02 * std::sin(1e4 * (x[0] + 3 * x[2]) + 2 * x[2]);
    return k == 2 ? noise - flow.downward(x[0] - 4, x[2] + 2) : k == 0 ? noise : 0;
  });
  const Table noisy = s.tables().at(0);
  const Quantity ratio = number(noisy, "velocity_over_drift"), sideways = number(noisy, "sideways_over_drift");
  EXPECT_GT(ratio.error, 1e-4);
  EXPECT_LT(std::abs(ratio.value - 2), 3 * ratio.error);
  EXPECT_LT(std::abs(sideways.value), 3 * sideways.error);
}

TEST(MeanFieldMeasurement, SaysWhereThereIsNoTheory) {
  const Table low = draining({{"lowest", 1.0}, {"highest", 4.0}}).tables().at(0);
  ASSERT_EQ(low.remarks.size(), 1U);
  EXPECT_NE(low.remarks[0].find("less than a radius above"), std::string::npos);
  for (std::size_t n = 0; n < column(low, "z").size(); ++n)
    EXPECT_EQ(std::isnan(column(low, "drift")[n]), column(low, "z")[n] < 2.6 + 0.3);
  FieldScene upwards = draining({});
  upwards.set("velocity", 3, [](const Vec3&, int k) { return k == 2 ? 1 : 0; });
  const Table none = upwards.tables().at(0);
  ASSERT_EQ(none.remarks.size(), 1U);
  EXPECT_TRUE(none.remarks[0].starts_with("No kinematic flow was fitted")) << none.remarks[0];
  EXPECT_TRUE(std::isnan(number(none, "velocity_over_drift").value));
}

TEST(MeanFieldMeasurement, RefusesOptionsThatDoNotGoTogether) {
  const MeasurementInfo info = mean_field_measurement();
  OptionValues options;
  for (const OptionInfo& o : info.options) options[o.name] = o.default_value;
  EXPECT_EQ(info.conflict(options)->option, "radius");
  options["radius"] = 2.6;
  EXPECT_FALSE(info.conflict(options));
  options["b"] = 2.28;
  EXPECT_EQ(info.conflict(options)->option, "discharge");
  options["discharge"] = 1.0;
  EXPECT_FALSE(info.conflict(options));
  options["influence"] = 0.0;
  EXPECT_EQ(info.conflict(options)->option, "influence");
  options["across"] = options["up"];
  EXPECT_EQ(info.conflict(options)->option, "across");
  EXPECT_EQ(info.needs(options).fields, (std::vector<std::string>{"phi", "velocity"}));
  EXPECT_FALSE(info.needs(options).particles);
}

}  // namespace
}  // namespace grainvdb::testing::mean_field_test
