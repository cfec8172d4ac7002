/// The section `species` of pipeline files.
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "grainvdb/plan.hpp"
#include "unit/pipeline/support.hpp"

namespace grainvdb::species_section_test {
namespace {

using test::PipelineFile;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string both =
    "species:\n"
    "  small: {types: [1, 3]}\n"
    "  large: {types: [2], diameter: [1.5e-3, .inf]}\n";

// Lines 1 to 9, then those of the section.
std::string text_with(const std::string& fields, const std::string& species) {
  return "grainvdb: 1\ninput:\n  particles: dumps/*.dump\nlattice:\n  voxel: 0.5\nkernel:\n  cutoff: 3\noutput:\n"
         "  fields: [" +
         fields + "]\n" + species;
}

Pipeline load(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const PipelineFile file(text);
  return load_pipeline(file.path(), overrides);
}

std::string refusal(const std::string& text) {
  try {
    const Pipeline p = load(text);
    make_plan(p);
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "not refused:\n" << text;
  return {};
}

TEST(SpeciesSection, NamesFieldsOfItsOwn) {
  const Pipeline p = load(text_with("phi_small, velocity_large_error, phi", both), {"species.rest.ids=[5, 9]"});
  ASSERT_EQ(p.species.size(), 3U);
  EXPECT_EQ(p.species[0].types, (std::vector<int>{1, 3}));
  EXPECT_EQ(p.species[1].diameter, std::pair(1.5e-3, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(p.species[2].name, "rest");
  EXPECT_EQ(p.species[2].ids, (std::pair<std::int64_t, std::int64_t>(5, 9)));

  // Saved in full it is the same pipeline.
  const Pipeline again = load(p.resolved);
  EXPECT_EQ(again.resolved, p.resolved);
  EXPECT_EQ(again.species[1].diameter, p.species[1].diameter);
}

TEST(SpeciesSection, PlansWhatItsFieldsNeed) {
  const Pipeline p = load(text_with("phi_small, contact_stress_large", both));
  const Plan plan = make_plan(p);
  ASSERT_EQ(plan.sweeps.size(), 1U);
  int channels = 0;
  for (const auto& pass : plan.sweeps[0].passes)
    for (const MomentPtr& moment : pass) channels += moment->channels;
  EXPECT_EQ(channels, 1 + 9);
  EXPECT_TRUE(plan.sweeps[0].columns.has(Column::type));
  EXPECT_THAT(describe(plan, p), AllOf(HasSubstr("species small: types 1, 3\n"),
                                       HasSubstr("species large: type 2 and diameter from 0.0015\n"),
                                       HasSubstr("volume of species small: 1 channel"),
                                       HasSubstr("  phi_small [1]: phi = sum V W"), Not(HasSubstr("(not written)"))));
}

TEST(SpeciesSection, SaysWhichFieldsThereAre) {
  EXPECT_THAT(refusal(text_with("mu_small", both)),
              HasSubstr("Of each species there are phi, density, velocity, mean_diameter, temperature, contact_stress, "
                        "kinetic_stress or stress, as in phi_small."));
  EXPECT_THAT(refusal(text_with("velocity_smal", both)), HasSubstr("Did you mean 'velocity_small'?"));
  EXPECT_THAT(refusal(text_with("phi_small", "")), HasSubstr("unknown name in output.fields"));
  EXPECT_THAT(refusal(text_with("temperature_small", both + "stages: {temperature: {mode: one_pass}}\n")),
              AllOf(HasSubstr(":13: "), HasSubstr("mode 'one_pass' for one species")));
  EXPECT_THAT(refusal(text_with("kinetic_stress_small", both + "stages: {kinetic_stress: {reference: "
                                                               "time_mean_moments}}\n")),
              HasSubstr("reference 'time_mean_moments' for one species"));
  EXPECT_THAT(refusal(text_with("velocity_small", both + "stages: {velocity_small: {weighting: mass}}\n")),
              HasSubstr("unknown stage 'velocity_small'"));
}

TEST(SpeciesSection, RefusesWhatCannotBeToldApart) {
  const auto refused = [](const std::string& species) { return refusal(text_with("phi", "species:\n" + species)); };
  EXPECT_THAT(refused("  a: {types: [1, 2]}\n  b: {types: [2, 3]}\n"),
              AllOf(HasSubstr(":12: "), HasSubstr("species 'a' and 'b' overlap"), HasSubstr("type 2 in both")));
  EXPECT_THAT(refused("  a: {diameter: [1, 3]}\n  b: {diameter: [2, 4]}\n"), HasSubstr("diameter 2.0 in both"));
  EXPECT_THAT(refused("  a: {}\n"), HasSubstr("species 'a' has no criterion"));
  EXPECT_THAT(refused("  a: {diameter: [3, 1]}\n"), HasSubstr("selects nothing"));
  EXPECT_THAT(refused("  a: {type: [1]}\n"), HasSubstr("Did you mean 'types'?"));
  EXPECT_THAT(refused("  a-b: {types: [1]}\n"), HasSubstr("a letter, then letters, digits and _"));
  EXPECT_THAT(refused("  error: {types: [1]}\n"), AllOf(HasSubstr(":11: "), HasSubstr("phi_error")));
  // What meets ends where the other begins; by different criteria, the grains will tell.
  EXPECT_EQ(load(text_with("phi", "species:\n  a: {diameter: [1, 2]}\n  b: {diameter: [2, 3]}\n  c: {types: [1]}\n"))
                .species.size(),
            3U);
}

TEST(SpeciesSection, ProfilesTakeItsFields) {
  const auto text = [](const std::string& fields) {
    return text_with("phi", both) + "measure:\n  profile:\n    fields: [" + fields + "]\n";
  };
  const Plan plan = make_plan(load(text("velocity_small, phi_large, mu")));
  std::vector<std::string> made;
  for (const Stage* stage : plan.stages) made.push_back(stage->name);
  EXPECT_THAT(made, testing::IsSupersetOf({"velocity_small", "phi_small", "phi_large", "stress"}));
  EXPECT_THAT(refusal(text("mu_small")), AllOf(HasSubstr("measure.profile.fields"), HasSubstr("as in phi_small")));
  EXPECT_THAT(refusal(text("phi_small_error")), HasSubstr("measure.profile.fields"));
  EXPECT_THAT(refusal(text("phi_tiny")), HasSubstr("measure.profile.fields"));
}

TEST(SpeciesSection, IsInTheJsonSchema) {
  const auto properties = nlohmann::json::parse(pipeline_schema()).at("properties");
  const auto& species = properties.at("species");
  EXPECT_EQ(species.at("additionalProperties").at("properties").size(), 3U);
  EXPECT_FALSE(species.at("additionalProperties").at("additionalProperties").get<bool>());
  const auto name = properties["output"]["properties"]["fields"]["anyOf"][0]["items"]["anyOf"][1]["pattern"];
  const std::regex pattern(name.get<std::string>());
  EXPECT_TRUE(std::regex_match("contact_stress_large", pattern));
  EXPECT_TRUE(std::regex_match("phi_small_error", pattern));
  EXPECT_FALSE(std::regex_match("mu_small", pattern));
  const auto averaged = properties["measure"]["properties"]["profile"]["properties"]["fields"].dump();
  EXPECT_THAT(averaged, HasSubstr("stress)_"));
}

}  // namespace
}  // namespace grainvdb::species_section_test
