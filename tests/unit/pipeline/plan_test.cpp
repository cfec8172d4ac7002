#include "grainvdb/plan.hpp"

#include <numbers>

#include <gmock/gmock.h>

#include "grainvdb/memory_model.hpp"
#include "unit/pipeline/support.hpp"

namespace grainvdb::plan_test {
namespace {

using test::example_moment;
using test::example_stage;
using testing::ElementsAre;
using testing::HasSubstr;

Pipeline wanting(const StageRegistry& registry, std::vector<std::string> fields) {
  Pipeline p;
  p.file = "p.yaml";
  p.fields = std::move(fields);
  p.stages = registry.default_settings();
  p.voxel = 1;
  p.cutoff = 3;
  p.where["kernel.cutoff"] = {"p.yaml", 7};
  p.where["output.fields"] = {"p.yaml", 9};
  return p;
}

std::vector<std::string> names(const std::vector<MomentPtr>& moments) {
  std::vector<std::string> result;
  for (const MomentPtr& m : moments) result.push_back(m->name);
  return result;
}

std::vector<std::string> names(const std::vector<const Stage*>& stages) {
  std::vector<std::string> result;
  for (const Stage* s : stages) result.push_back(s->name);
  return result;
}

std::string refusal(const Pipeline& pipeline, const StageRegistry& registry) {
  try {
    make_plan(pipeline, registry);
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "not refused";
  return {};
}

TEST(Plan, PhiAloneReadsTheRadiusAndComputesOneMoment) {
  const StageRegistry registry = test::example_registry();
  const Plan plan = make_plan(wanting(registry, {"phi"}), registry);
  ASSERT_EQ(plan.sweeps.size(), 1U);
  EXPECT_EQ(plan.sweeps[0].columns, ColumnSet(Column::radius));
  ASSERT_EQ(plan.sweeps[0].passes.size(), 1U);
  EXPECT_THAT(names(plan.sweeps[0].passes[0]), ElementsAre("volume"));
  EXPECT_THAT(names(plan.means), ElementsAre("volume"));
  EXPECT_THAT(names(plan.stages), ElementsAre("phi"));
  EXPECT_THAT(plan.not_needed,
              ElementsAre("velocity", "temperature", "stress", "contact_stress", "kinetic_stress", "mu"));
}

TEST(Plan, TemperatureTakesTwoPassesOverEachFrame) {
  const StageRegistry registry = test::example_registry();
  const Plan plan = make_plan(wanting(registry, {"temperature"}), registry);
  ASSERT_EQ(plan.sweeps.size(), 1U);
  ASSERT_EQ(plan.sweeps[0].passes.size(), 2U);
  EXPECT_THAT(names(plan.sweeps[0].passes[0]), ElementsAre("volume", "volume flux"));
  EXPECT_THAT(names(plan.sweeps[0].passes[1]), ElementsAre("fluctuation"));
  EXPECT_EQ(plan.sweeps[0].columns, Column::radius | Column::velocity);
  // The flux is only needed within the frame.
  EXPECT_THAT(names(plan.means), ElementsAre("volume", "fluctuation"));
}

TEST(Plan, KineticStressAboutTheTimeMeanTakesTwoSweeps) {
  const StageRegistry registry = test::example_registry();
  const Plan plan = make_plan(wanting(registry, {"kinetic_stress"}), registry);
  ASSERT_EQ(plan.sweeps.size(), 2U);
  ASSERT_EQ(plan.sweeps[0].passes.size(), 1U);
  EXPECT_THAT(names(plan.sweeps[0].passes[0]), ElementsAre("volume", "volume flux"));
  EXPECT_EQ(plan.sweeps[0].columns, Column::radius | Column::velocity);
  ASSERT_EQ(plan.sweeps[1].passes.size(), 1U);
  EXPECT_THAT(names(plan.sweeps[1].passes[0]), ElementsAre("kinetic"));
  EXPECT_EQ(plan.sweeps[1].columns, Column::mass | Column::velocity);
  EXPECT_THAT(names(plan.means), ElementsAre("volume", "volume flux", "kinetic"));
}

TEST(Plan, MomentsOfALaterSweepBringTheirFrameNeedsAgain) {
  const auto a = example_moment({.name = "a", .columns = Column::radius});
  const auto b = example_moment({.name = "b", .columns = Column::velocity});
  const auto c = example_moment({.name = "c", .columns = Column::mass, .frame_needs = {a}, .mean_needs = {b}});
  StageRegistry registry;
  registry.add(example_stage("f", {}, {c}));
  const Plan plan = make_plan(wanting(registry, {"f"}), registry);
  ASSERT_EQ(plan.sweeps.size(), 2U);
  EXPECT_THAT(names(plan.sweeps[0].passes.at(0)), ElementsAre("a", "b"));
  ASSERT_EQ(plan.sweeps[1].passes.size(), 2U);
  EXPECT_THAT(names(plan.sweeps[1].passes[0]), ElementsAre("a"));
  EXPECT_THAT(names(plan.sweeps[1].passes[1]), ElementsAre("c"));
  EXPECT_EQ(plan.sweeps[1].columns, Column::radius | Column::mass);
}

TEST(Plan, VoxelMomentsFollowTheirNeedsWithoutAnotherPass) {
  const auto a = example_moment({.name = "a"});
  const auto square = example_moment({.name = "square", .kind = Moment::Kind::voxels, .frame_needs = {a}});
  const auto root = example_moment({.name = "root", .kind = Moment::Kind::voxels, .frame_needs = {square, a}});
  const auto deviation = example_moment({.name = "deviation", .frame_needs = {root}});
  StageRegistry registry;
  registry.add(example_stage("f", {}, {deviation, square}));
  const Plan plan = make_plan(wanting(registry, {"f"}), registry);
  ASSERT_EQ(plan.sweeps.at(0).passes.size(), 2U);
  EXPECT_THAT(names(plan.sweeps[0].passes[0]), ElementsAre("a", "square", "root"));
  EXPECT_THAT(names(plan.sweeps[0].passes[1]), ElementsAre("deviation"));
}

TEST(Plan, StagesFollowTheirNeedsAndThenTheRegistry) {
  const StageRegistry registry = test::example_registry();
  const Plan plan = make_plan(wanting(registry, {"mu", "phi"}), registry);
  EXPECT_THAT(names(plan.stages), ElementsAre("phi", "contact_stress", "kinetic_stress", "stress", "mu"));
  EXPECT_TRUE(plan.sweeps.at(0).columns.has(Column::contacts));
  EXPECT_FALSE(plan.sweeps.at(1).columns.has(Column::contacts));
  EXPECT_THAT(names(make_plan(wanting(registry, {"phi", "mu"}), registry).stages),
              testing::ContainerEq(names(plan.stages)));
}

TEST(Plan, ASelectionByTypeReadsTheTypes) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"phi"});
  p.select.types = {1};
  EXPECT_EQ(make_plan(p, registry).sweeps.at(0).columns, Column::radius | Column::type);
  p.select = {};
  p.select.ids = {1, 2};
  EXPECT_EQ(make_plan(p, registry).sweeps.at(0).columns, ColumnSet(Column::radius));
}

TEST(Plan, OptionsDecideWhatIsNeeded) {
  const auto fast = example_moment({.name = "fast"}), slow = example_moment({.name = "slow"});
  Stage stage = example_stage("f", {}, {});
  stage.options = {{.name = "exact", .default_value = false, .help = "whether"}};
  stage.needs = [=](const StageSettings& s) { return StageNeeds{{}, {option<bool>(s, "f", "exact") ? slow : fast}}; };
  StageRegistry registry;
  registry.add(stage);
  Pipeline p = wanting(registry, {"f"});
  EXPECT_THAT(names(make_plan(p, registry).means), ElementsAre("fast"));
  p.stages["f"]["exact"] = true;
  EXPECT_THAT(names(make_plan(p, registry).means), ElementsAre("slow"));
}

TEST(Plan, UnknownFieldsAreRefused) {
  const StageRegistry registry = test::example_registry();
  EXPECT_THAT(
      refusal(wanting(registry, {"phy"}), registry),
      testing::AllOf(testing::StartsWith("p.yaml:9: no stage makes the field 'phy', which output.fields asks for"),
                     HasSubstr("Did you mean 'phi'?")));
  StageRegistry broken;
  broken.add(example_stage("a", {"b"}, {}));
  EXPECT_THAT(refusal(wanting(broken, {"a"}), broken), HasSubstr("the field 'b', which stage 'a' asks for"));
}

TEST(Plan, CyclesAreNamed) {
  StageRegistry registry;
  registry.add(example_stage("top", {"a"}, {}));
  registry.add(example_stage("a", {"b"}, {}));
  registry.add(example_stage("b", {"c"}, {}));
  registry.add(example_stage("c", {"a"}, {}));
  EXPECT_THAT(refusal(wanting(registry, {"top"}), registry),
              testing::AllOf(HasSubstr("in a circle"), HasSubstr("found a -> b -> c -> a")));
  StageRegistry self;
  self.add(example_stage("a", {"a"}, {}));
  EXPECT_THAT(refusal(wanting(self, {"a"}), self), HasSubstr("a -> a"));
}

TEST(Plan, OptionsThatDoNotGoTogetherAreRefusedWhereTheStageIsWanted) {
  const StageRegistry& registry = StageRegistry::standard();
  Pipeline p = wanting(registry, {"temperature"});
  p.stages.at("temperature").at("mode") = std::string("two_pass_profile");
  p.stages.at("temperature").at("self_weight") = std::string("corrected");
  p.where["stages.temperature.self_weight"] = {"p.yaml", 12};
  const std::string text = refusal(p, registry);
  EXPECT_THAT(text, HasSubstr("p.yaml:12"));
  EXPECT_THAT(text, HasSubstr("self_weight 'corrected' with mode 'two_pass_profile'"));
  p.fields = {"phi"};
  EXPECT_NO_THROW(make_plan(p, registry));
}

TEST(Plan, InterpolationNeedsAWideKernel) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"phi", "temperature"});
  p.voxel = 2;
  p.cutoff = 3.4;  // sqrt(3) voxels are 3.4641
  EXPECT_THAT(refusal(p, registry),
              testing::AllOf(testing::StartsWith("p.yaml:7: the kernel is too narrow for 'temperature'"),
                             HasSubstr("kernel.cutoff 3.4 at lattice.voxel 2.0"), HasSubstr("3.4641")));
  p.fields = {"mu"};  // through stress and kinetic_stress
  EXPECT_THAT(refusal(p, registry), HasSubstr("too narrow for 'kinetic_stress'"));
  p.fields = {"phi", "velocity", "contact_stress"};
  EXPECT_NO_THROW(make_plan(p, registry));
  p.fields = {"temperature"};
  p.cutoff = std::numbers::sqrt3 * p.voxel;
  EXPECT_NO_THROW(make_plan(p, registry));
}

TEST(Plan, NoParticleMayFallBetweenTheVoxels) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"phi"});
  p.voxel = 2;
  p.limits.volume_error = 10;
  p.cutoff = 1.73;  // half a voxel diagonal is 1.73205
  EXPECT_THAT(refusal(p, registry),
              testing::AllOf(testing::StartsWith("p.yaml:7: the kernel is so narrow"),
                             HasSubstr("kernel.cutoff 1.73 at lattice.voxel 2"), HasSubstr("1.732")));
  p.cutoff = 1.7321;
  EXPECT_NO_THROW(make_plan(p, registry));
}

TEST(Plan, CoarseVoxelsAreRefusedUnlessTheLimitAllowsThem) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"phi"});
  p.voxel = 2;
  p.cutoff = 2.5;  // 1.25 voxels: 0.244
  try {
    make_plan(p, registry);
    FAIL() << "not refused";
  } catch (const LimitError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("the voxels are too coarse for the kernel"),
                                         HasSubstr("a cutoff of 1.25 voxels"), HasSubstr("off by up to 0.24"),
                                         HasSubstr("limits.volume_error = 0.05")));
  }
  p.limits.volume_error = 0.25;
  EXPECT_NO_THROW(make_plan(p, registry));
}

TEST(Plan, DifferentMomentsOfOneNameAreAProgrammingError) {
  StageRegistry registry;
  registry.add(example_stage("a", {}, {example_moment({.name = "m", .channels = 1})}));
  registry.add(example_stage("b", {}, {example_moment({.name = "m", .channels = 2})}));
  EXPECT_THROW(make_plan(wanting(registry, {"a", "b"}), registry), std::logic_error);
}

TEST(Describe, SaysWhatIsReadComputedWrittenAndLeftOut) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"velocity"});
  p.formats = {"hdf5"};
  p.input.units = "si";
  const std::string text = describe(make_plan(p, registry), p);
  EXPECT_THAT(text, HasSubstr("sweep 1 of 1\n  reads id, position, velocity, radius\n  pass 1 over each frame\n"));
  EXPECT_THAT(text, HasSubstr("volume flux: 3 channels, splat of particles"));
  EXPECT_THAT(text, HasSubstr("velocity [m/s]: equation of velocity\n"));
  EXPECT_THAT(text, HasSubstr("peak memory: " + to_string(memory_model(make_plan(p, registry), p))));
  EXPECT_THAT(text, HasSubstr("written: velocity as hdf5"));
  EXPECT_THAT(text, HasSubstr("not read: angular velocity, mass, type, contacts\n"));
  EXPECT_THAT(text, HasSubstr("not needed: phi, temperature, stress"));
}

TEST(Describe, MarksFieldsThatAreNotWrittenAndTimeMeans) {
  const StageRegistry registry = test::example_registry();
  const Pipeline p = wanting(registry, {"stress"});
  const std::string text = describe(make_plan(p, registry), p);
  EXPECT_THAT(text, HasSubstr("sweep 2 of 2"));
  EXPECT_THAT(text, HasSubstr("from the time mean of volume, volume flux"));
  EXPECT_THAT(text, HasSubstr("equation of kinetic_stress (not written)\n"));
  EXPECT_THAT(text, HasSubstr("equation of stress\n"));
  EXPECT_THAT(text, HasSubstr("contact_stress [mass/(length time^2)]"));  // no unit system is known
}

TEST(Describe, SaysHowFramesAreAveraged) {
  const StageRegistry registry = test::example_registry();
  Pipeline p = wanting(registry, {"phi"});
  const auto text = [&] { return describe(make_plan(p, registry), p); };
  EXPECT_THAT(text(), HasSubstr("frames: all; averaged over all of them\n"));
  // A sum and a number of samples in double, a field in float.
  EXPECT_THAT(text(), HasSubstr(" + 23 V bytes\n"));
  p.window = 1;
  EXPECT_THAT(text(), HasSubstr("frames: all; each by itself\n"));
  p.window = 100;
  p.window_step = 4;
  EXPECT_THAT(text(), HasSubstr("averaged over windows of 100 frames, one every 4 frames\n"));
  EXPECT_THAT(text(), HasSubstr(" + 484 V bytes\n"));  // 26 sums
}

TEST(Describe, DrawsTheGraph) {
  const StageRegistry registry = test::example_registry();
  const Pipeline p = wanting(registry, {"stress"});
  const std::string dot = describe_dot(make_plan(p, registry), p);
  EXPECT_THAT(dot, testing::StartsWith("digraph grainvdb {"));
  EXPECT_THAT(dot, HasSubstr("\"column:radius\" -> \"moment:volume\";"));
  EXPECT_THAT(dot, HasSubstr("\"moment:volume\" -> \"moment:kinetic\" [style=dashed"));
  EXPECT_THAT(dot, HasSubstr("\"moment:kinetic\" -> \"field:kinetic_stress\";"));
  EXPECT_THAT(dot, HasSubstr("\"field:kinetic_stress\" -> \"field:stress\";"));
  EXPECT_THAT(dot, HasSubstr("\"field:stress\" -> \"output\";"));
  EXPECT_THAT(dot, testing::Not(HasSubstr("phi")));
}

}  // namespace
}  // namespace grainvdb::plan_test
