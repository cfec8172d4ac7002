// What is tried by default.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/tune.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::knobs_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::Not;

std::map<std::string, std::vector<std::string>> knobs_for(const std::vector<std::string>& fields) {
  const Pipeline p = shear_cell_pipeline(fields);
  const auto source = open_dumps(p.input);
  std::map<std::string, std::vector<std::string>> found;
  for (const Knob& k : default_knobs(p, make_plan(p), *source)) found[k.key] = k.values;
  return found;
}

// Periods of 16 voxels of 0.4 mm, five frames.
TEST(Knobs, VoxelsFitThePeriodsAndFramesAreThinnedOut) {
  const auto knobs = knobs_for({"phi"});
  EXPECT_EQ(knobs.size(), 3U) << "nothing else concerns phi";
  EXPECT_THAT(knobs.at("kernel.accumulation"), ElementsAre("float", "double"));
  EXPECT_THAT(knobs.at("frames"), ElementsAre("::2", "::4"));
  for (const std::string& value : knobs.at("lattice.voxel")) {
    const double count = 6.4e-3 / std::stod(value);
    EXPECT_NEAR(count, std::round(count), 1e-6) << value;
    EXPECT_NE(std::round(count), 16) << "the current one";
  }
  EXPECT_THAT(knobs.at("lattice.voxel"), ElementsAre("0.0008", "0.000581818182", "0.000304761905", "0.0002"));
}

TEST(Knobs, OptionsOfStagesThatRun) {
  const auto knobs = knobs_for({"mu", "temperature", "shear_rate"});
  EXPECT_THAT(knobs.at("stages.contact_stress.line_integral"), IsSupersetOf({"gauss1", "midpoint_curvature", "exact"}));
  EXPECT_THAT(knobs.at("stages.contact_stress.line_integral"), Not(Contains("adaptive"))) << "the current one";
  EXPECT_THAT(knobs.at("stages.kinetic_stress.reference"), ElementsAre("time_mean_moments"));
  EXPECT_THAT(knobs.at("stages.velocity_gradient.method"), ElementsAre("kernel"));
  EXPECT_THAT(knobs.at("stages.temperature.mode"), Contains("one_pass"));
  EXPECT_FALSE(knobs.contains("stages.rotational_fluctuation.mode"));
}

TEST(Knobs, OfTracersAndProfiles) {
  const auto knobs_with = [](const std::vector<std::string>& overrides) {
    const Pipeline p = load_pipeline(in_repository("pipelines/shear_cell.yaml"), overrides);
    const auto source = open_dumps(p.input);
    std::map<std::string, Knob> found;
    for (const Knob& k : default_knobs(p, make_plan(p), *source)) found[k.key] = k;
    return found;
  };
  const auto tracers = knobs_with({"trace.seeds.grid.spacing=1e-3", "trace.steps=5"});
  EXPECT_THAT(tracers.at("trace.interpolation").values, ElementsAre("cubic"));
  EXPECT_FALSE(tracers.contains("measure.profile"));
  const Knob exact =
      knobs_with({"measure.profile.fields=[phi]", "measure.profile.from=5e-3", "measure.profile.to=9e-3"})
          .at("measure.profile");
  EXPECT_THAT(exact.values, ElementsAre("null"));
  EXPECT_THAT(exact.along, ElementsAre("measure.plane_profile.axis=z", "measure.plane_profile.from=0.005",
                                       "measure.plane_profile.to=0.009"));
  const Knob voxels = knobs_with({"measure.plane_profile.axis=z"}).at("measure.plane_profile");
  EXPECT_THAT(voxels.along, Contains("measure.profile.axis=z"));
  // Planes normal to y cut the open sides of the cell; shells have no exact average.
  for (const char* other : {"axis=y", "geometry=shells", "points=16", "bin=1e-3"}) {
    const auto found = knobs_with({"measure.profile.fields=[phi]", std::string("measure.profile.") + other});
    EXPECT_EQ(found.contains("measure.profile"), false) << other;
  }
}

}  // namespace
}  // namespace grainvdb::testing::knobs_test
