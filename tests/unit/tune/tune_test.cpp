// Settings measured on the sample shear cell, by a clock that only counts.
#include "grainvdb/tune.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/error.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::tune_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TuneRequest request(const std::string& fields) {
  TuneRequest r;
  r.file = in_repository("pipelines/shear_cell.yaml");
  r.overrides = {"output.fields=[" + fields + "]", "frames=:2"};
  r.repeats = 1;
  r.clock = [ticks = 0.0]() mutable { return ticks += 1; };
  return r;
}

TuneReport tune_sample(const TuneRequest& r) {
  const auto source = open_dumps(shear_cell_input());
  return tune(r, *source);
}

TEST(Tune, SmallerVoxelsComeCloser) {
  TuneRequest r = request("phi,velocity,velocity_error,frames");
  r.overrides.emplace_back("average.blocks=2");
  r.knobs = {{"lattice.voxel", {"0.8e-3", "0.2e-3"}}};
  const TuneReport report = tune_sample(r);
  EXPECT_THAT(report.fields, ElementsAre("phi", "velocity"));
  EXPECT_THAT(report.not_compared, ElementsAre("velocity_error", "frames"));
  ASSERT_EQ(report.trials.size(), 3U);
  EXPECT_GT(report.reference_points, 1000U);
  for (std::size_t field = 0; field < 2; ++field) {
    const auto rms = [&](std::size_t trial) { return report.trials[trial].errors.at(field).rms; };
    EXPECT_GT(rms(0), 0);
    EXPECT_LT(rms(2), rms(0));
    EXPECT_GT(rms(1), 2 * rms(0));  // interpolation errs with the square of the voxel
    EXPECT_LT(rms(1), 0.2);
  }
  for (const Trial& t : report.trials) EXPECT_THAT(t.seconds, ElementsAre(1));
  EXPECT_FALSE(report.proposal_meets && report.proposed != 0) << "no tolerance was named";
}

TEST(Tune, RefusedSettingsAreReported) {
  TuneRequest r = request("phi");
  r.knobs = {{"lattice.voxel", {"0.3e-3"}}, {"kernel.cutoff", {"1.6e-3"}}};
  const TuneReport report = tune_sample(r);
  EXPECT_THAT(report.trials.at(1).refused, HasSubstr("lattice.voxel"));
  EXPECT_TRUE(report.trials.at(2).refused.empty());
}

TEST(Tune, RefusesWhatItCannotCompare) {
  TuneRequest r = request("phi,frames");
  r.tolerance = {{"frames", 0.1}};
  EXPECT_THROW(tune_sample(r), ConfigError);
  r.tolerance = {{"phi", 0.1}};
  r.most_runs = 3;
  EXPECT_THROW(tune_sample(r), LimitError);
}

}  // namespace
}  // namespace grainvdb::testing::tune_test
