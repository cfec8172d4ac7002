// Nothing that is not needed is read, splatted or allocated.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/measurement.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::parsimony_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

Result run_on_shear_cell(Pipeline p) {
  const auto source = open_dumps(p.input);
  return run(p, *source);
}

bool splats(const Plan& plan, Moment::Kind kind) {
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& pass : sweep.passes)
      for (const MomentPtr& m : pass)
        if (m->kind == kind) return true;
  return false;
}

TEST(Parsimony, PackingFractionAlone) {
  const Result r = run_on_shear_cell(shear_cell_pipeline({"phi"}));
  ASSERT_EQ(r.plan.sweeps.size(), 1U);
  EXPECT_EQ(r.plan.sweeps[0].columns, ColumnSet(Column::radius));
  ASSERT_EQ(r.plan.stages.size(), 1U);
  EXPECT_EQ(r.plan.stages[0]->name, "phi");
  EXPECT_EQ(r.plan.not_needed.size() + 1, StageRegistry::standard().stages().size());

  EXPECT_THAT(r.report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "radius"));
  EXPECT_EQ(r.report.read.files_opened.size(), 5U);
  EXPECT_THAT(r.report.read.files_opened, Not(Contains(HasSubstr("/contacts"))));
  EXPECT_EQ(r.report.read.frames_read, 5U);

  EXPECT_EQ(r.report.channels, 1U);
  EXPECT_EQ(r.report.grids, 1U);
  EXPECT_FALSE(r.only().has_mask);
  EXPECT_FALSE(r.record.layouts.at(0).has_mask);
}

// A pipeline that asks for g(r) alone: positions are read once, nothing is splatted, and no lattice is needed.
TEST(Parsimony, PairCorrelationAlone) {
  Pipeline p = shear_cell_pipeline({});
  p.voxel = p.cutoff = 0;
  OptionValues options;
  for (const OptionInfo& option : find_measurement("pair_correlation")->options)
    options[option.name] = option.default_value;
  p.measure["pair_correlation"] = options;
  const Plan plan = make_plan(p);
  EXPECT_TRUE(plan.sweeps.empty());
  EXPECT_TRUE(plan.stages.empty());
  const auto source = open_dumps(p.input);
  const RunReport report = measure(p, *source);
  EXPECT_EQ(report.channels, 0U);
  EXPECT_EQ(report.grids, 0U);
  EXPECT_THAT(report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "radius"));
  EXPECT_EQ(report.read.files_opened.size(), 5U);
  EXPECT_EQ(report.read.frames_read, 5U);
  ASSERT_EQ(report.tables.size(), 1U);
  EXPECT_EQ(report.tables[0].name, "pair_correlation");
}

TEST(Parsimony, DensityReadsNoRadius) {
  const Result r = run_on_shear_cell(shear_cell_pipeline({"density"}));
  EXPECT_THAT(r.report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "mass"));
  EXPECT_EQ(r.report.grids, 1U);
}

TEST(Parsimony, VelocityAlone) {
  const Result r = run_on_shear_cell(shear_cell_pipeline({"velocity"}));
  EXPECT_THAT(r.report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "radius", "vx", "vy", "vz"));
  EXPECT_EQ(r.report.channels, 4U);
  EXPECT_EQ(r.report.grids, 3U);
  EXPECT_EQ(r.report.read.frames_read, 5U);
  EXPECT_TRUE(r.only().has_mask);  // it can be undefined
}

TEST(Parsimony, MassWeightedVelocityReadsNoRadius) {
  Pipeline p = shear_cell_pipeline({"velocity"});
  set_option(p, "velocity", "weighting", std::string("mass"));
  const Result r = run_on_shear_cell(p);
  EXPECT_THAT(r.report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "mass", "vx", "vy", "vz"));
}

TEST(Parsimony, ContactStressAloneSplatsNoParticles) {
  const Result r = run_on_shear_cell(shear_cell_pipeline({"contact_stress"}));
  EXPECT_TRUE(splats(r.plan, Moment::Kind::contacts));
  EXPECT_FALSE(splats(r.plan, Moment::Kind::particles));
  EXPECT_EQ(r.report.channels, 9U);
  EXPECT_EQ(r.report.grids, 9U);
  for (const char* name : {"vx", "omegax", "mass", "type"})
    EXPECT_THAT(r.report.read.columns_parsed, Not(Contains(name)));
  EXPECT_THAT(r.report.read.files_opened, Contains(HasSubstr("contacts60000")));
}

TEST(Parsimony, SelectionReadsTypes) {
  Pipeline p = shear_cell_pipeline({"phi"});
  p.select.types = {1};
  const Result r = run_on_shear_cell(p);
  EXPECT_THAT(r.report.read.columns_parsed, UnorderedElementsAre("id", "x", "y", "z", "radius", "type"));
}

TEST(Parsimony, OnlySelectedFramesAreRead) {
  Pipeline p = shear_cell_pipeline({"phi"});
  p.frames = {1, 4, 2};
  const Result r = run_on_shear_cell(p);
  EXPECT_EQ(r.report.frames, 2U);
  EXPECT_EQ(r.report.read.frames_read, 2U);
  EXPECT_EQ(r.only().time.first_step, 64000);
  EXPECT_EQ(r.only().time.last_step, 72000);
  EXPECT_NEAR(r.only().time.time, 68000e-6, 1e-15);
}

// The time mean of u must be known before the kinetic stress: two sweeps, but nothing is splatted twice for the mean.
TEST(Parsimony, KineticStressTakesTwoSweeps) {
  Pipeline p = shear_cell_pipeline({"kinetic_stress"});
  const Result r = run_on_shear_cell(p);
  ASSERT_EQ(r.plan.sweeps.size(), 2U);
  EXPECT_FALSE(r.plan.sweeps[0].columns.has(Column::mass));
  EXPECT_EQ(r.report.channels, 4U + 6U);
  EXPECT_EQ(r.report.grids, 9U);

  set_option(p, "kinetic_stress", "reference", std::string("instantaneous"));
  EXPECT_EQ(make_plan(p).sweeps.size(), 1U);
}

// Stages that run for others only are not written.
TEST(Parsimony, IntermediateFieldsAreNotWritten) {
  const Result r = run_on_shear_cell(shear_cell_pipeline({"mu"}));
  EXPECT_EQ(r.only().fields.size(), 1U);
  std::vector<std::string> ran;
  for (const Stage* s : r.plan.stages) ran.push_back(s->name);
  // density and velocity say what rounding leaves of the pressure: pressure_floor.
  EXPECT_THAT(ran, UnorderedElementsAre("contact_stress", "kinetic_stress", "stress", "pressure", "shear_stress", "mu",
                                        "density", "velocity", "pressure_floor"));
}

}  // namespace
}  // namespace grainvdb::testing::parsimony_test
