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

TEST(Tune, IsPlannedAsItRuns) {
  TuneRequest r = request("phi,frames");
  r.knobs = {{"lattice.voxel", {"0.3e-3", "0.8e-3"}}};
  const auto source = open_dumps(shear_cell_input());
  const std::size_t frames_read = source->counters().frames_read;
  const TunePlan plan = plan_tuning(r, *source);
  EXPECT_EQ(source->counters().frames_read, frames_read) << "nothing is computed";
  EXPECT_EQ(plan.runs, 1U + 3);
  EXPECT_THAT(plan.not_compared, ElementsAre("frames"));
  ASSERT_EQ(plan.settings.size(), 3U);
  const TuneReport report = tune(r, *source);
  EXPECT_EQ(plan.reference, report.reference);
  EXPECT_EQ(plan.fields, report.fields);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(plan.settings[n].set, report.trials[n].set);
    EXPECT_EQ(plan.settings[n].refused, report.trials[n].refused);
  }
  EXPECT_THAT(describe(plan), HasSubstr("lattice.voxel=0.3e-3: not possible: "));
  r.reference = {"lattice.voxel=0.3e-3"};
  EXPECT_THROW(plan_tuning(r, *source), ConfigError);
}

// Of the other knobs: closed form and double are what the reference has, float errs more than shifted.
TEST(Tune, LineIntegralsAndSums) {
  TuneRequest r = request("phi,contact_stress");
  r.knobs = {{"stages.contact_stress.line_integral", {"midpoint_curvature", "exact"}},
             {"kernel.accumulation", {"float", "double"}}};
  const TuneReport report = tune_sample(r);
  EXPECT_THAT(report.reference,
              ::testing::IsSupersetOf({"stages.contact_stress.line_integral=exact", "kernel.accumulation=double"}));
  ASSERT_EQ(report.trials.size(), 5U);
  for (const Trial& t : report.trials) {
    EXPECT_TRUE(t.refused.empty()) << t.refused;
    // Voxels decide: line integrals and sums err by less than a tenth of what they do.
    for (std::size_t field = 0; field < 2; ++field)
      EXPECT_NEAR(t.errors.at(field).rms / report.trials[0].errors.at(field).rms, 1, 0.1) << t.name();
  }
}

// Planes: the voxels' averages have the ripple of the lattice sum, 2.4e-5 at c/h = 6 at most; the exact ones none.
TEST(Tune, ProfilesOfVoxelsAndExactOnes) {
  TuneRequest r = request("phi");
  r.overrides.emplace_back("measure.profile.fields=[phi,velocity,pressure]");
  r.knobs = {{"measure.profile", {"null"}, {"measure.plane_profile.axis=z"}}, {"frames", {":1"}}};
  r.tolerance = {{"profile.phi", 1e-3}};
  const TuneReport report = tune_sample(r);
  EXPECT_THAT(report.fields, ElementsAre("phi", "profile.phi", "profile.velocity"));
  const auto rms = [&](std::size_t trial, std::size_t column) { return report.trials[trial].errors.at(column).rms; };
  for (std::size_t column : {1U, 2U}) {
    EXPECT_GT(report.trials[0].errors.at(column).points, 20U);
    EXPECT_GT(rms(0, column), 0);
    EXPECT_LT(rms(0, column), 2.4e-5);
    EXPECT_EQ(rms(1, column), 0);
    EXPECT_GT(rms(2, column), 1e-3) << "one of two frames";
  }
  EXPECT_THAT(report.trials[1].set, ElementsAre("measure.profile=null", "measure.plane_profile.axis=z"));
  EXPECT_EQ(report.trials[1].knobs, 1U);
}

// Tracers come closer by splines, through the mean and through frames.
TEST(Tune, TracersByTheirInterpolation) {
  for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{
           {"trace.steps=20", "trace.duration=0.2"}, {"trace.through=frames", "average.window=none"}}) {
    TuneRequest r = request("phi");
    r.overrides.insert(r.overrides.end(), how.begin(), how.end());
    r.overrides.emplace_back("trace.seeds.grid.spacing=2e-3");
    r.knobs = {{"trace.interpolation", {"cubic"}}};
    const TuneReport report = tune_sample(r);
    EXPECT_THAT(report.fields, ElementsAre("phi", "position"));
    EXPECT_GT(report.trials[0].errors.at(1).points, 20U);
    EXPECT_GT(report.trials[0].errors.at(1).rms, 0);
    EXPECT_LT(report.trials[1].errors.at(1).rms, 0.5 * report.trials[0].errors.at(1).rms);
    EXPECT_EQ(report.trials[1].errors.at(0).rms, report.trials[0].errors.at(0).rms);
  }
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
