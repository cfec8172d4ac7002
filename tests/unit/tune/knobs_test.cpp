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
  EXPECT_EQ(knobs.size(), 2U) << "nothing else concerns phi";
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
  EXPECT_THAT(knobs.at("stages.contact_stress.line_integral"), Contains("gauss1"));
  EXPECT_THAT(knobs.at("stages.contact_stress.line_integral"), Not(Contains("adaptive"))) << "the current one";
  EXPECT_THAT(knobs.at("stages.kinetic_stress.reference"), ElementsAre("time_mean_moments"));
  EXPECT_THAT(knobs.at("stages.velocity_gradient.method"), ElementsAre("kernel"));
  EXPECT_THAT(knobs.at("stages.temperature.mode"), Contains("one_pass"));
  EXPECT_FALSE(knobs.contains("stages.rotational_fluctuation.mode"));
}

}  // namespace
}  // namespace grainvdb::testing::knobs_test
