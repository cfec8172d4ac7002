#include "pipeline/schema.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "unit/pipeline/support.hpp"

namespace grainvdb::schema_test {
namespace {

using Json = nlohmann::json;

Json example_schema() {
  return Json::parse(pipeline_schema(test::example_registry()));
}

TEST(PipelineSchema, ListsEveryKeyAndNoOther) {
  const StageRegistry registry = test::example_registry();
  const Json json = example_schema();
  const Schema schema = make_schema(registry);
  EXPECT_GT(schema.keys.size(), 25U);
  for (const KeyInfo& key : schema.keys) {
    const Json* at = &json;
    std::string rest = key.path();
    for (std::size_t dot; (dot = rest.find('.')) != std::string::npos; rest.erase(0, dot + 1))
      at = &at->at("properties").at(rest.substr(0, dot));
    EXPECT_FALSE(at->at("additionalProperties").get<bool>()) << key.path();
    const Json& value = at->at("properties").at(rest);
    EXPECT_EQ(value.at("description").get<std::string>().find(key.help), 0U) << key.path();
    EXPECT_EQ(value.contains("default"), key.default_value.has_value()) << key.path();
    const Json required = at->value("required", Json::array());
    EXPECT_EQ(std::count(required.begin(), required.end(), rest), key.required ? 1 : 0) << key.path();
  }
}

TEST(PipelineSchema, StatesTypesRangesAndChoices) {
  const Json json = example_schema()["properties"];
  EXPECT_EQ(json["lattice"]["properties"]["voxel"]["exclusiveMinimum"], 0);
  EXPECT_EQ(json["lattice"]["properties"]["origin"]["maxItems"], 3);
  EXPECT_EQ(json["kernel"]["properties"]["name"]["enum"], Json::array({"lucy"}));
  const Json stages = json["stages"]["properties"];
  EXPECT_EQ(stages["mu"]["properties"]["strict"]["type"], "boolean");
  EXPECT_EQ(stages["mu"]["properties"]["axes"]["default"], Json::array({"x"}));
  EXPECT_EQ(stages["contact_stress"]["properties"]["points"]["maximum"], 8);
  EXPECT_EQ(stages["temperature"]["properties"]["mode"]["enum"].size(), 3U);
  EXPECT_EQ(json["output"]["properties"]["fields"]["anyOf"][0]["items"]["enum"].size(),
            test::example_registry().stages().size());
}

TEST(Schema, HasAHelpTextForEverything) {
  const Schema schema = make_schema(test::example_registry());
  for (const KeyInfo& key : schema.keys) EXPECT_FALSE(key.help.empty()) << key.path();
  for (const SectionInfo& section : schema.sections) EXPECT_FALSE(section.help.empty()) << section.path;
}

}  // namespace
}  // namespace grainvdb::schema_test
