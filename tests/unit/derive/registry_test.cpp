#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::registry_test {
namespace {

struct Expected {
  int components;
  const char* unit;
};

// The names, components and units that users and scripts rely on.
TEST(DerivedStages, DescribeThemselves) {
  const std::map<std::string, Expected> expected{{"velocity_gradient", {9, "1/s"}},
                                                 {"angular_velocity_gradient", {9, "1/(m s)"}},
                                                 {"shear_rate", {1, "1/s"}},
                                                 {"pressure", {1, "Pa"}},
                                                 {"pressure_floor", {1, "Pa"}},
                                                 {"shear_stress", {1, "Pa"}},
                                                 {"mu", {1, "1"}},
                                                 {"inertial_number", {1, "1"}},
                                                 {"regime", {1, "1"}},
                                                 {"fluidity", {1, "1/s"}},
                                                 {"gd_over_dv", {1, "1"}},
                                                 {"rotational_temperature", {1, "m^2/s^2"}},
                                                 {"g_over_domega", {1, "1"}},
                                                 {"dv_over_d_domega", {1, "1"}},
                                                 {"principal_stress", {3, "Pa"}},
                                                 {"principal_axes", {9, "1"}},
                                                 {"principal_gap", {1, "1"}},
                                                 {"mu_mohr_coulomb", {1, "1"}},
                                                 {"slip_lines", {6, "1"}},
                                                 {"coaxiality_angle", {1, "1"}},
                                                 {"mean_extreme_stress", {1, "Pa"}},
                                                 {"spot_drift", {3, "kg/(m^2 s^2)"}}};
  FakeInput in = one_voxel();
  const UnitSystem& si = *find_unit_system("si");
  std::set<std::string> found;
  for (const Stage& stage : in.registry().stages()) {
    if (stage.name == "velocity" || stage.name == "angular_velocity") continue;
    ASSERT_TRUE(expected.contains(stage.name)) << stage.name;
    EXPECT_EQ(stage.components, expected.at(stage.name).components) << stage.name;
    EXPECT_EQ(si.symbol(stage.dimension), expected.at(stage.name).unit) << stage.name;
    EXPECT_EQ(stage.additive, stage.name.starts_with("pressure")) << stage.name;
    EXPECT_FALSE(stage.description.empty()) << stage.name;
    EXPECT_FALSE(stage.equation.empty()) << stage.name;
    found.insert(stage.name);
  }
  EXPECT_EQ(found.size(), expected.size());
}

TEST(DerivedStages, NeedOnlyFieldsThatExist) {
  const std::set<std::string> base{"phi",           "density", "velocity",    "angular_velocity",
                                   "mean_diameter", "stress",  "temperature", "rotational_fluctuation"};
  FakeInput in = one_voxel();
  for (const Stage& stage : in.registry().stages())
    for (const std::string& need : stage.needs(in.settings()).fields)
      EXPECT_TRUE(base.contains(need) || in.registry().find(need) != nullptr) << stage.name << " needs " << need;
}

TEST(DerivedStages, ThresholdsAreDeclaredOnceAndCannotBeNegative) {
  std::map<std::string, int> declared;
  FakeInput in = one_voxel();
  for (const Stage& stage : in.registry().stages())
    for (const OptionInfo& o : stage.options) {
      ++declared[o.name];
      if (std::holds_alternative<double>(o.default_value)) {
        EXPECT_EQ(o.minimum, 0) << o.name;
      }
    }
  for (const char* name : {"pressure_min", "temperature_min", "rotational_fluctuation_min", "mu_min"})
    EXPECT_EQ(declared[name], 1) << name;
}

}  // namespace
}  // namespace grainvdb::testing::registry_test
