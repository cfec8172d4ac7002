// What the coarse-grained fields say of themselves: names, shapes, units, needs.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_view.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb::testing::description_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const StageRegistry registry = make_registry();

TEST(FieldDescriptions, NamesShapesAndUnits) {
  struct Known {
    const char* name;
    int components;
    const char* unit;
    bool additive;
  };
  const UnitSystem& si = *find_unit_system("si");
  for (const Known& k :
       {Known{"phi", 1, "1", true}, Known{"density", 1, "kg/m^3", true}, Known{"velocity", 3, "m/s", false},
        Known{"mean_diameter", 1, "m", false}, Known{"temperature", 1, "m^2/s^2", false},
        Known{"angular_velocity", 3, "1/s", false}, Known{"rotational_fluctuation", 1, "1/s^2", false},
        Known{"contact_stress", 9, "Pa", true}, Known{"kinetic_stress", 9, "Pa", true}, Known{"stress", 9, "Pa", true},
        Known{"wall_force", 3, "kg/(m^2 s^2)", true}, Known{"frames", 1, "1", true}, Known{"mask", 1, "1", true}}) {
    const Stage* s = registry.find(k.name);
    ASSERT_NE(s, nullptr) << k.name;
    EXPECT_EQ(s->components, k.components) << k.name;
    EXPECT_EQ(si.symbol(s->dimension), k.unit) << k.name;
    EXPECT_EQ(s->additive, k.additive) << k.name;
    EXPECT_FALSE(s->description.empty()) << k.name;
    EXPECT_FALSE(s->equation.empty()) << k.name;
  }
  EXPECT_FALSE(registry.find("mask")->compute);
}

TEST(FieldDescriptions, DefaultsAreThoseOfThePaper) {
  const StageSettings s = registry.default_settings();
  EXPECT_EQ(option<std::string>(s, "velocity", "weighting"), "volume");
  EXPECT_EQ(option<std::string>(s, "temperature", "mode"), "two_pass");
  EXPECT_EQ(option<std::string>(s, "rotational_fluctuation", "mode"), "two_pass");
  EXPECT_EQ(option<std::string>(s, "contact_stress", "line_integral"), "adaptive");
  EXPECT_EQ(option<std::string>(s, "kinetic_stress", "reference"), "time_mean");
  EXPECT_THAT(option<std::vector<std::string>>(s, "temperature", "homogeneous"), ElementsAre("x", "y"));
}

TEST(FieldDescriptions, ColumnsThatMustBeRead) {
  const StageSettings s = registry.default_settings();
  const auto columns = [&](const std::string& stage) {
    ColumnSet all;
    for (const MomentPtr& m : moments_of(registry, stage, s)) all |= m->columns;
    return all;
  };
  EXPECT_EQ(columns("phi"), ColumnSet(Column::radius));
  EXPECT_EQ(columns("density"), ColumnSet(Column::mass));
  EXPECT_EQ(columns("velocity"), Column::radius | Column::velocity);
  EXPECT_EQ(columns("mean_diameter"), ColumnSet(Column::radius));
  EXPECT_EQ(columns("temperature"), Column::radius | Column::velocity);
  EXPECT_EQ(columns("angular_velocity"), Column::radius | Column::angular_velocity);
  EXPECT_EQ(columns("rotational_fluctuation"), Column::radius | Column::angular_velocity);
  EXPECT_EQ(columns("kinetic_stress"), Column::mass | Column::velocity);
  EXPECT_TRUE(columns("contact_stress").has(Column::contacts));
  EXPECT_FALSE(columns("contact_stress").has(Column::velocity));
  const StageSettings by_mass = settings_with(registry, {{"velocity", "weighting", "mass"}});
  for (const MomentPtr& m : moments_of(registry, "velocity", by_mass))
    EXPECT_FALSE(m->columns.has(Column::radius)) << m->name;
}

// One more pass for means of the frame, one more sweep for means over time, neither otherwise.
TEST(FieldDescriptions, PassesAndSweeps) {
  const auto deviation = [&](const std::string& stage, const StageSettings& s) {
    return moments_of(registry, stage, s).at(0);
  };
  const StageSettings defaults = registry.default_settings();
  EXPECT_EQ(deviation("temperature", defaults)->frame_needs.size(), 2U);
  EXPECT_THAT(deviation("temperature", defaults)->mean_needs, IsEmpty());
  EXPECT_EQ(deviation("kinetic_stress", defaults)->mean_needs.size(), 2U);
  EXPECT_THAT(deviation("kinetic_stress", defaults)->frame_needs, IsEmpty());
  const StageSettings instantaneous = settings_with(registry, {{"kinetic_stress", "reference", "instantaneous"}});
  EXPECT_EQ(deviation("kinetic_stress", instantaneous)->frame_needs.size(), 2U);
  EXPECT_THAT(deviation("kinetic_stress", instantaneous)->mean_needs, IsEmpty());
  const StageSettings moments = settings_with(registry, {{"kinetic_stress", "reference", "time_mean_moments"}});
  EXPECT_EQ(deviation("kinetic_stress", moments)->kind, Moment::Kind::second_moments);
  for (const MomentPtr& m : moments_of(registry, "kinetic_stress", moments)) {
    EXPECT_THAT(m->frame_needs, IsEmpty());
    EXPECT_THAT(m->mean_needs, IsEmpty());
  }
  EXPECT_THAT(registry.find("kinetic_stress")->needs(moments).fields, ElementsAre("velocity_gradient"));
  const StageSettings one_pass = settings_with(registry, {{"temperature", "mode", "one_pass"}});
  EXPECT_EQ(deviation("temperature", one_pass)->kind, Moment::Kind::voxels);

  EXPECT_THAT(registry.find("temperature")->needs(one_pass).fields, IsEmpty());
  const StageSettings corrected = settings_with(registry, {{"temperature", "mode", "one_pass_corrected"}});
  EXPECT_THAT(registry.find("temperature")->needs(corrected).fields, ElementsAre("velocity_gradient"));
  const StageSettings spin = settings_with(registry, {{"rotational_fluctuation", "mode", "one_pass_corrected"}});
  EXPECT_THAT(registry.find("rotational_fluctuation")->needs(spin).fields, ElementsAre("angular_velocity_gradient"));
  EXPECT_THAT(registry.find("stress")->needs(defaults).fields, ElementsAre("contact_stress", "kinetic_stress"));
}

// Self-weight is left in where the mean is one over many particles; asking for both is refused.
TEST(FieldDescriptions, SelfWeightOfAProfileIsNotTakenOff) {
  for (const char* stage : {"temperature", "rotational_fluctuation"})
    for (const char* mode : {"two_pass", "two_pass_profile", "one_pass", "one_pass_corrected"})
      for (const char* weight : {"none", "corrected"}) {
        const StageSettings s = settings_with(registry, {{stage, "mode", mode}, {stage, "self_weight", weight}});
        const auto conflict = registry.find(stage)->conflict(s);
        EXPECT_EQ(conflict.has_value(), mode == std::string("two_pass_profile") && weight == std::string("corrected"));
        if (conflict) {
          EXPECT_EQ(conflict->option, "self_weight");
        }
      }
}

// Moments are merged by name: what an option changes must change the name.
TEST(FieldDescriptions, NamesTellMomentsApart) {
  std::set<std::string> names;
  std::size_t variants = 0;
  const auto add = [&](const std::string& stage, const std::vector<std::array<std::string, 3>>& changes) {
    names.insert(moments_of(registry, stage, settings_with(registry, changes)).at(0)->name);
    ++variants;
  };
  for (const char* mode : {"two_pass", "two_pass_profile", "one_pass"}) {
    add("temperature", {{"temperature", "mode", mode}});
    add("rotational_fluctuation", {{"rotational_fluctuation", "mode", mode}});
  }
  add("contact_stress", {});
  for (const char* method : {"exact", "midpoint_curvature"})
    add("contact_stress", {{"contact_stress", "line_integral", method}});
  for (int n = 1; n <= 8; ++n)
    add("contact_stress", {{"contact_stress", "line_integral", "gauss" + std::to_string(n)}});
  add("contact_stress", {{"contact_stress", "wall_contacts", "exclude"}});
  add("kinetic_stress", {});
  add("kinetic_stress", {{"kinetic_stress", "reference", "instantaneous"}});
  add("kinetic_stress", {{"kinetic_stress", "reference", "time_mean_moments"}});
  add("velocity", {});
  add("velocity", {{"velocity", "weighting", "mass"}});
  EXPECT_EQ(names.size(), variants);

  StageSettings along_z = registry.default_settings();
  along_z.at("temperature").at("mode") = std::string("two_pass_profile");
  along_z.at("temperature").at("homogeneous") = std::vector<std::string>{"z"};
  EXPECT_FALSE(names.contains(moments_of(registry, "temperature", along_z).at(0)->name));
}

}  // namespace
}  // namespace grainvdb::testing::description_test
