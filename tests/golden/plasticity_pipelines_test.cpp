// The pipelines that measure the sample silo: plasticity and drainage.
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/run.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::plasticity_pipelines_test {
namespace {

std::map<std::string, Table> tables_of(const std::string& pipeline) {
  const Pipeline p = load_pipeline(in_repository("pipelines/" + pipeline));
  const auto source = open_dumps(p.input);
  std::map<std::string, Table> tables;
  for (const Table& t : run_pipeline(p, make_plan(p), *source, {}).tables) tables.emplace(t.name, t);
  return tables;
}

double number(const Table& table, const std::string& name) {
  for (const Quantity& q : table.numbers)
    if (q.name == name) return q.value;
  throw std::out_of_range(name);
}

// What these hypotheses are known for holds here too: the material does not yield everywhere, stress and strain rate
// are nearly aligned where it flows, and the packing fraction tells the shear rate better than the friction.
TEST(PlasticityPipeline, TestsTheHypothesesOnTheSilo) {
  const auto tables = tables_of("plasticity.yaml");
  EXPECT_GT(number(tables.at("incipient_yield"), "relative_spread"), 0.1);
  EXPECT_LT(number(tables.at("incipient_yield"), "undefined_share"), 0.2);
  EXPECT_LT(number(tables.at("coaxiality"), "mean"), 0.7);            // 1 for random axes
  EXPECT_LT(number(tables.at("stochastic_flow_rule"), "mean"), 1.2);  // π/2 for random directions
  EXPECT_GT(number(tables.at("box_strain_rate"), "boxes"), 20);
  EXPECT_GT(number(tables.at("box_strain_rate"), "grid_over_boxes"), 0.5);  // the kernel smooths
  EXPECT_LT(number(tables.at("box_strain_rate"), "grid_over_boxes"), 1.1);
  EXPECT_GT(number(tables.at("collapse_shear_rate"), "collapse"), 0.2);
  EXPECT_FALSE(tables.at("spot_streamlines").columns.at(0).values.empty());
}

// b of ∂v/∂z = b ∂²v/∂x², in grain diameters, by both ways of measuring it.
TEST(KinematicPipeline, FindsOneBByTwoWays) {
  const auto tables = tables_of("kinematic.yaml");
  const double of_flow = number(tables.at("kinematic_fit"), "b");
  const double of_widths = number(tables.at("kinematic_width"), "b");
  EXPECT_GT(of_flow, 0.8);
  EXPECT_LT(of_flow, 2.5);
  EXPECT_NEAR(of_flow, of_widths, 0.3 * of_flow);
}

// The theory of spots makes the fall; sideways it makes the flow of an incompressible one, or somewhat more.
TEST(KinematicPipeline, FindsTheFlowOfSpots) {
  const auto tables = tables_of("kinematic.yaml");
  const Table& flow = tables.at("mean_field");
  EXPECT_EQ(number(flow, "b"), number(tables.at("kinematic_fit"), "b"));
  EXPECT_NEAR(number(flow, "velocity_over_drift"), 1, 0.03);
  EXPECT_GT(number(flow, "sideways_over_drift"), 0.5);
  EXPECT_LT(number(flow, "sideways_over_drift"), 1.1);
  EXPECT_TRUE(flow.remarks.empty());
}

}  // namespace
}  // namespace grainvdb::testing::plasticity_pipelines_test
