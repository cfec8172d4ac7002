#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/frame.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb::registry_test {
namespace {

Stage stage(const std::string& name, std::vector<OptionInfo> options = {}) {
  Stage s;
  s.name = name;
  s.options = std::move(options);
  return s;
}

TEST(StageRegistry, FindsStagesByNameInOrderOfRegistration) {
  StageRegistry registry;
  registry.add(stage("b"));
  registry.add(stage("a"));
  EXPECT_EQ(registry.find("a"), &registry.stages()[1]);
  EXPECT_EQ(registry.find("c"), nullptr);
  EXPECT_THROW(registry.add(stage("b")), std::invalid_argument);
}

TEST(StageRegistry, DefaultSettingsAreThoseOfTheDeclarations) {
  StageRegistry registry;
  OptionInfo mode;
  mode.name = "mode";
  mode.default_value = std::string("two_pass");
  OptionInfo points;
  points.name = "points";
  points.default_value = std::int64_t{3};
  registry.add(stage("temperature", {mode, points}));
  registry.add(stage("phi"));
  const StageSettings settings = registry.default_settings();
  EXPECT_EQ(option<std::string>(settings, "temperature", "mode"), "two_pass");
  EXPECT_EQ(option<std::int64_t>(settings, "temperature", "points"), 3);
  EXPECT_TRUE(settings.at("phi").empty());
}

TEST(ColumnSet, NamesWhatIsRead) {
  EXPECT_EQ(column_names({}), (std::vector<std::string>{"id", "position"}));
  EXPECT_EQ(column_names(Column::radius | Column::contacts),
            (std::vector<std::string>{"id", "position", "radius", "contacts"}));
}

TEST(ColumnSet, UnitesColumns) {
  ColumnSet set = Column::mass;
  set |= Column::velocity | Column::mass;
  EXPECT_TRUE(set.has(Column::velocity));
  EXPECT_TRUE(set.has(Column::mass));
  EXPECT_FALSE(set.has(Column::type));
  EXPECT_EQ(set, Column::velocity | Column::mass);
}

TEST(SphereVolume, IsFourThirdsPiRCubed) {
  EXPECT_DOUBLE_EQ(sphere_volume(3), 36 * std::numbers::pi);
}

TEST(ForEachLeaf, VisitsEveryLeafOnce) {
  std::vector<Coord> origins;
  LeafMask mask;
  mask.set(0);
  for (std::int32_t i = 0; i < 500; ++i) origins.push_back({8 * i, 0, 0});
  const Topology topology(origins, std::vector<LeafMask>(origins.size(), mask));
  std::vector<std::atomic<int>> visits(topology.leaf_count());
  for_each_leaf(topology, [&](std::size_t l) { ++visits[l]; });
  for (const auto& n : visits) EXPECT_EQ(n, 1);
}

}  // namespace
}  // namespace grainvdb::registry_test
