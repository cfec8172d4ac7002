// Strain rates in boxes and the kinematic fit, as measurements.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kinematic.hpp"
#include "measure/plasticity.hpp"
#include "support/random.hpp"
#include "unit/measure/field_scene.hpp"

namespace grainvdb::testing::drainage_test {
namespace {

const Lattice lattice(0.5, {0, 0, 0});
const Box box{{0, 0, 0}, {10, 8, 10}, {false, true, false}};

/// Grains of diameter 1 anywhere in the box with the velocity (2z, 0, x/2), in a frame of time 1.
Frame sheared_grains(std::size_t n, const Vec3& hi) {
  Random random(17);
  Frame frame;
  frame.box = box;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 x{random.uniform(0, hi[0]), random.uniform(0, hi[1]), random.uniform(0, hi[2])};
    const Vec3 v{2 * x[2], 0, x[0] / 2};
    frame.particles.id.push_back(static_cast<std::int64_t>(k + 1));
    frame.particles.radius.push_back(0.5);
    for (std::size_t i = 0; i < 3; ++i) {
      frame.particles.position[i].push_back(x[i]);
      frame.particles.velocity[i].push_back(v[i]);
    }
  }
  return frame;
}

FieldScene boxes(const OptionValues& options = {}) {
  FieldScene s(box_strain_rate_measurement(), lattice, voxels_between({0, 0, 0}, {19, 15, 19}), options);
  s.set("phi", 0.6);
  s.set("velocity_gradient", 9, [](const Vec3&, int k) { return k == 2 ? 2 : k == 6 ? 0.5 : 0; });
  return s;
}

TEST(BoxStrainRate, OfGrainsAndGridInAPureShear) {
  const FieldScene s = boxes();
  EXPECT_TRUE(s.needs().particles->has(Column::radius));
  const auto measurement = s.make(box);
  measurement->take(s.fields());  // before the frame, as well as after it
  measurement->add(sheared_grains(2000, {10, 8, 10}));
  const Table t = measurement->tables().at(0);
  EXPECT_EQ(number(t, "boxes").value, 16);  // 4 × 1 × 4 of 2.5 × 8 × 2.5
  for (std::size_t n = 0; n < 16; ++n) {
    EXPECT_NEAR(column(t, "shear_rate")[n], 2.5, 1e-11);  // 2|D_xz|
    EXPECT_NEAR(column(t, "grid_shear_rate")[n], 2.5, 1e-6);
    for (const char* component : {"xx", "yy", "zz", "xy", "yz"}) {
      EXPECT_NEAR(column(t, std::string("strain_rate_") + component)[n], 0, 1e-11);
      EXPECT_NEAR(column(t, std::string("grid_strain_rate_") + component)[n], 0, 1e-6);
    }
    EXPECT_NEAR(column(t, "strain_rate_xz")[n], 1.25, 1e-11);
    EXPECT_LT(column(t, "condition")[n], 2);
    EXPECT_EQ(column(t, "y")[n], 4);
  }
  EXPECT_NEAR(number(t, "grid_over_boxes").value, 1, 1e-6);
  EXPECT_TRUE(t.remarks.empty());
}

TEST(BoxStrainRate, RefusesTooFewParticlesAndFlatBoxes) {
  const FieldScene s = boxes({{"size", std::vector<double>{5, 8, 5}}});
  EXPECT_FALSE(s.needs().particles->has(Column::radius));
  const auto few = s.make(box);
  few->add(sheared_grains(19, {4, 8, 4}));
  Table t = few->tables().at(0);
  EXPECT_EQ(number(t, "boxes").value, 0);
  EXPECT_EQ(number(t, "refused_few").value, 1);
  ASSERT_EQ(t.remarks.size(), 1U);
  EXPECT_NE(t.remarks[0].find("fewer than 20 particles"), std::string::npos);

  const auto flat = s.make(box);
  flat->add(sheared_grains(500, {4, 8, 0.1}));
  t = flat->tables().at(0);
  EXPECT_EQ(number(t, "refused_condition").value, 1);
  EXPECT_EQ(number(t, "boxes").value, 0);

  // Two frames of the few are enough.
  const auto twice = s.make(box);
  twice->add(sheared_grains(19, {4, 8, 4}));
  twice->add(sheared_grains(19, {4, 8, 4}));
  EXPECT_EQ(number(twice->tables().at(0), "boxes").value, 1);
  EXPECT_TRUE(s.make(box)->tables().at(0).columns[0].values.empty());
}

TEST(BoxStrainRate, SizeHasThreeNumbersOrNone) {
  const MeasurementInfo info = box_strain_rate_measurement();
  EXPECT_FALSE(info.conflict({{"size", std::vector<double>{}}}).has_value());
  EXPECT_FALSE(info.conflict({{"size", std::vector<double>{1, 2, 3}}}).has_value());
  EXPECT_TRUE(info.conflict({{"size", std::vector<double>{1}}}).has_value());
}

/// The kinematic flow down from a slot at x = 4, z = -2, in a lattice of 0.5.
FieldScene draining(const OptionValues& options = {}) {
  OptionValues all{{"slot", 4.0}, {"bottom", -2.0}};
  for (const auto& [name, value] : options) all[name] = value;
  FieldScene s(kinematic_fit_measurement(), lattice, voxels_between({-20, 0, 0}, {36, 3, 60}), all);
  const KinematicFlow flow{2.28, 1.7};
  s.set("phi", 0.6);
  s.set("velocity", 3, [=](const Vec3& x, int k) {
    const double across = x[0] - 4;
    const double up = x[2] + 2;
    return k == 0 ? flow.sideways(across, up) : k == 1 ? 0 : -flow.downward(across, up);
  });
  return s;
}

// Velocities are rounded to float, 3e-8 relative each: of 2000 of them b is good to much better than 1e-6.
TEST(KinematicFit, RecoversTheFlow) {
  const std::vector<Table> tables = draining().tables();
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_NEAR(number(tables[0], "b").value, 2.28, 1e-6 * 2.28);
  EXPECT_NEAR(number(tables[0], "discharge").value, 1.7, 1e-6 * 1.7);
  EXPECT_NEAR(number(tables[1], "b").value, 2.28, 1e-5 * 2.28);
  EXPECT_NEAR(number(tables[1], "offset").value, 0, 1e-4);
  EXPECT_TRUE(tables[0].remarks.empty());
  EXPECT_TRUE(tables[1].remarks.empty());
  for (std::size_t n = 0; n < column(tables[0], "z").size(); ++n) {
    EXPECT_GE(column(tables[0], "z")[n], 3);  // the kernel's cutoff
    EXPECT_NEAR(column(tables[0], "fitted")[n], column(tables[0], "velocity")[n], 1e-7);
  }
  for (std::size_t n = 0; n < column(tables[1], "z").size(); ++n) EXPECT_NEAR(column(tables[1], "middle")[n], 0, 1e-4);
}

TEST(KinematicFit, KeepsToTheWindowThatIsGiven) {
  const Table t = draining({{"lowest", 5.0}, {"highest", 12.0}, {"half_width", 6.0}}).tables()[0];
  double lo = 1e9, hi = 0, far = 0;
  for (std::size_t n = 0; n < column(t, "z").size(); ++n) {
    lo = std::min(lo, column(t, "z")[n]);
    hi = std::max(hi, column(t, "z")[n]);
    far = std::max(far, std::abs(column(t, "x")[n]));
  }
  EXPECT_EQ(lo, 5.25);
  EXPECT_EQ(hi, 11.75);
  EXPECT_EQ(far, 5.75);
  EXPECT_NEAR(number(t, "b").value, 2.28, 1e-5);
}

// Three output times whose b differ, as those of blocks of a run do: the jackknife over them is the error of their
// mean.
TEST(KinematicFit, TakesErrorsFromOutputTimes) {
  const auto flow_of = [](double b) {
    FieldScene s = draining();
    const KinematicFlow flow{b, 1.7};
    s.set("velocity", 3, [=](const Vec3& x, int k) { return k == 2 ? -flow.downward(x[0] - 4, x[2] + 2) : 0; });
    return s;
  };
  const auto measurement = draining().make();
  std::vector<double> b{2.0, 2.3, 2.45};
  for (const double value : b) {
    const FieldScene s = flow_of(value);
    measurement->take(s.fields());
  }
  const std::vector<Table> tables = measurement->tables();
  const double mean = 2.25, variance = (0.25 * 0.25 + 0.05 * 0.05 + 0.2 * 0.2) / 2;
  for (const Table& t : tables) {
    EXPECT_NEAR(number(t, "b").value, mean, 0.03);  // of the mean flow, not the mean of b
    EXPECT_NEAR(number(t, "b").error, std::sqrt(variance / 3), 0.2 * std::sqrt(variance / 3));
    EXPECT_EQ(t.remarks.size(), 1U);
  }
}

TEST(KinematicFit, SaysWhyThereIsNone) {
  FieldScene s = draining();
  s.set("velocity", 3, [](const Vec3&, int) { return 0.0; });
  const std::vector<Table> tables = s.tables();
  ASSERT_EQ(tables[0].remarks.size(), 1U);
  EXPECT_EQ(tables[0].remarks[0], "No kinematic flow was fitted: there is no downward flow to fit.");
  EXPECT_EQ(tables[1].remarks.size(), 2U);
  EXPECT_TRUE(std::isnan(number(tables[0], "b").value));
  const MeasurementInfo info = kinematic_fit_measurement();
  EXPECT_TRUE(info.conflict({{"up", std::string("z")}, {"across", std::string("z")}}).has_value());
  EXPECT_FALSE(info.conflict({{"up", std::string("y")}, {"across", std::string("z")}}).has_value());
}

}  // namespace
}  // namespace grainvdb::testing::drainage_test
