#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "grainvdb/measurement.hpp"
#include "measure/register.hpp"
#include "unit/measure/synthetic.hpp"

namespace grainvdb::profile_test {
namespace {

using testing::column_of;

const Lattice lattice(0.5, {0, 0, 0});
const StageSettings stages;

Table profile_of(OptionValues options, const std::vector<OutputFields>& outputs) {
  const auto measurement = profile_measurements().front().make({options, stages, lattice, LucyKernel(1.5), Box{}, {}});
  for (const OutputFields& output : outputs) measurement->take(output);
  return measurement->tables().front();
}

OptionValues options_for(const std::vector<std::string>& fields) {
  OptionValues options = testing::defaults_of(profile_measurements().front());
  options["fields"] = fields;
  return options;
}

/// Rigid rotation about z with a hoop stress, φ = ½.
OutputFields rotation(double rate) {
  return testing::synthetic_output(lattice, {-4, -4, 0}, {4, 4, 3},
                                   {testing::scalar("phi", [](const Vec3&) { return 0.5; }),
                                    {"velocity", 3,
                                     [=](const Vec3& x, std::span<double> out) {
                                       out[0] = -rate * x[1];
                                       out[1] = rate * x[0];
                                       out[2] = 0;
                                     }},
                                    {"stress", 9, [](const Vec3& x, std::span<double> out) {
                                       const double r = std::hypot(x[0], x[1]);
                                       const Vec3 hoop{-x[1] / r, x[0] / r, 0};
                                       for (std::size_t i = 0; i < 9; ++i)
                                         out[i] = -4 * hoop[i / 3] * hoop[i % 3] - (i % 4 == 0 ? 1 : 0);
                                     }}});
}

TEST(Profile, ShellsHaveColumnsOfTheirDirections) {
  OptionValues options = options_for({"phi", "velocity", "stress", "pressure"});
  options["geometry"] = std::string("shells");
  std::vector<OutputFields> outputs;
  outputs.push_back(rotation(2));
  outputs.push_back(rotation(4));
  const Table table = profile_of(options, outputs);
  EXPECT_EQ(table.columns.front().name, "r");
  EXPECT_EQ(table.columns.size(), 3U + 2 * (1 + 3 + 9 + 1));
  const std::vector<double>& r = column_of(table, "r");
  ASSERT_FALSE(r.empty());
  for (std::size_t n = 0; n < r.size(); ++n) {
    EXPECT_NEAR(column_of(table, "velocity_theta")[n], 3 * r[n], 1e-6 * r[n]);
    EXPECT_NEAR(column_of(table, "velocity_r")[n], 0, 1e-6 * r[n]);
    // Two values 2r and 4r: the error of their mean is r.
    EXPECT_NEAR(column_of(table, "velocity_theta_error")[n], r[n], 1e-6 * r[n]);
    EXPECT_NEAR(column_of(table, "stress_rr")[n], -1, 1e-6);
    EXPECT_NEAR(column_of(table, "stress_thetatheta")[n], -5, 1e-6);
    EXPECT_NEAR(column_of(table, "stress_rtheta")[n], 0, 1e-6);
    EXPECT_NEAR(column_of(table, "stress_zz")[n], -1, 1e-6);
    EXPECT_NEAR(column_of(table, "pressure")[n], 7.0 / 3, 1e-6);
  }
  for (const TableColumn& column : table.columns) EXPECT_EQ(column.values.size(), r.size()) << column.name;
}

TEST(Profile, NeedsWhatItsRatiosAreMadeOf) {
  const MeasurementInfo info = profile_measurements().front();
  const auto needs = [&](const std::vector<std::string>& fields) {
    const std::vector<std::string> all = info.needs(options_for(fields)).fields;
    return std::set<std::string>(all.begin(), all.end());
  };
  EXPECT_EQ(needs({"phi"}), (std::set<std::string>{"phi"}));
  EXPECT_EQ(needs({"temperature"}), (std::set<std::string>{"phi", "temperature"}));
  EXPECT_EQ(needs({"mu", "density"}), (std::set<std::string>{"stress", "pressure_floor", "density"}));
  EXPECT_FALSE(info.needs(options_for({"phi"})).particles);
}

TEST(Profile, FieldsOfSpeciesAreWeighedByTheirOwnGrains) {
  const MeasurementInfo info = profile_measurements().front();
  EXPECT_EQ(info.needs(options_for({"phi_a", "stress_a", "velocity_b"})).fields,
            (std::vector<std::string>{"phi_a", "phi_b", "stress_a", "velocity_b"}));
  // φ_a grows along x, φ_b is what is left of ½; b moves with x.
  std::vector<OutputFields> outputs;
  outputs.push_back(testing::synthetic_output(lattice, {0, 0, 0}, {7, 3, 2},
                                              {testing::scalar("phi", [](const Vec3&) { return 0.5; }),
                                               testing::scalar("phi_a", [](const Vec3& x) { return 0.1 * x[0]; }),
                                               testing::scalar("phi_b", [](const Vec3& x) { return 0.5 - 0.1 * x[0]; }),
                                               {"velocity_b", 3, [](const Vec3& x, std::span<double> out) {
                                                  out[0] = x[0];
                                                  out[1] = out[2] = 0;
                                                }}}));
  const Table table = profile_of(options_for({"phi", "phi_a", "phi_b", "velocity_b"}), outputs);
  double weight = 0, sum = 0;
  for (int i = 0; i < 8; ++i) {
    const double x = lattice.centre(0, i);
    weight += 0.5 - 0.1 * x;
    sum += (0.5 - 0.1 * x) * x;
  }
  ASSERT_EQ(column_of(table, "z").size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(column_of(table, "phi_a")[n] + column_of(table, "phi_b")[n], column_of(table, "phi")[n], 1e-7);
    EXPECT_NEAR(column_of(table, "velocity_b_x")[n], sum / weight, 1e-6);
  }
  const auto column =
      std::find_if(table.columns.begin(), table.columns.end(), [](const TableColumn& c) { return c.name == "phi_b"; });
  EXPECT_EQ(column->description, "packing fraction, of species b alone, average");
}

TEST(Profile, OffersNoMeanOfAxes) {
  const MeasurementInfo info = profile_measurements().front();
  for (const OptionInfo& option : info.options) {
    if (option.name != "fields") continue;
    EXPECT_EQ(std::count(option.choices.begin(), option.choices.end(), "principal_axes"), 0);
    EXPECT_EQ(std::count(option.choices.begin(), option.choices.end(), "coaxiality_angle"), 1);
  }
}

TEST(MeasurementRegistry, DescribesItself) {
  std::set<std::string> names;
  for (const MeasurementInfo& info : measurement_registry()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.description.empty() || info.equation.empty()) << info.name;
    EXPECT_TRUE(info.needs && info.make) << info.name;
    std::set<std::string> options;
    for (const OptionInfo& option : info.options) {
      EXPECT_TRUE(options.insert(option.name).second) << info.name << ' ' << option.name;
      EXPECT_FALSE(option.help.empty()) << info.name << ' ' << option.name;
    }
    const OptionValues defaults = testing::defaults_of(info);
    // Some places only the user knows.
    if (const auto lacking = info.conflict ? info.conflict(defaults) : std::nullopt) {
      EXPECT_TRUE(options.contains(lacking->option) && lacking->found == "none") << info.name << ' ' << lacking->option;
    }
    for (const std::string& field : info.needs(defaults).fields)
      EXPECT_NE(StageRegistry::standard().find(field), nullptr) << info.name << ' ' << field;
    EXPECT_EQ(find_measurement(info.name), &info);
  }
  EXPECT_EQ(find_measurement("no such measurement"), nullptr);
}

}  // namespace
}  // namespace grainvdb::profile_test
