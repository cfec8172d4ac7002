// From averaged moments to fields: ratios, what is undefined and why.
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fake_view.hpp"

namespace grainvdb::testing::stages_test {
namespace {

/// One leaf with three active voxels (0, 1, 2) and moments given by name.
class FakeInput : public StageInput {
 public:
  explicit FakeInput(StageSettings settings) : settings_(std::move(settings)) {
    LeafMask mask;
    for (int v : {0, 1, 2}) mask.set(v);
    topology_ = std::make_shared<const Topology>(std::vector<Coord>{{0, 0, 0}}, std::vector<LeafMask>{mask});
    mask_ = std::make_unique<Mask>(topology_);
    frames_ = {2, 1, 2};
    frames_.resize(leaf_size);
  }
  void set(const std::string& moment, int channel, std::vector<double> values) {
    values.resize(leaf_size);
    moments_[{moment, channel}] = std::move(values);
  }
  SparseField& add_field(const std::string& name, int components) {
    return fields_.emplace(name, SparseField({name, "1", components, "", "", 0}, topology_, lattice_)).first->second;
  }
  SparseField compute(const Stage& stage) {
    SparseField out({stage.name, "1", stage.components, "", "", std::numeric_limits<float>::quiet_NaN()}, topology_,
                    lattice_);
    stage.compute(*this, out);
    return out;
  }
  bool noted(int voxel, Reason r) const { return (mask_->leaf(0)[voxel] & static_cast<std::uint32_t>(r)) != 0; }

  const Lattice& lattice() const override { return lattice_; }
  const LucyKernel& kernel() const override { return kernel_; }
  const StageSettings& settings() const override { return settings_; }
  const Topology& topology() const override { return *topology_; }
  const SparseField& field(const std::string& name) const override { return fields_.at(name); }
  const double* moment(std::size_t, const Moment& m, int channel) const override {
    return moments_.at({m.name, channel}).data();
  }
  const double* frame_count(std::size_t) const override { return frames_.data(); }
  Mask& mask() const override { return *mask_; }

 private:
  StageSettings settings_;
  Lattice lattice_{1, {0, 0, 0}};
  LucyKernel kernel_{6};
  std::shared_ptr<const Topology> topology_;
  std::unique_ptr<Mask> mask_;
  std::vector<double> frames_;
  std::map<std::pair<std::string, int>, std::vector<double>> moments_;
  std::map<std::string, SparseField> fields_;
};

const StageRegistry registry = make_registry();

TEST(FieldStages, AdditiveFieldsAreTheirMoment) {
  FakeInput in(registry.default_settings());
  in.set("volume", 0, {0.5, 0.25, 0});
  const SparseField phi = in.compute(*registry.find("phi"));
  EXPECT_EQ(phi.leaf(0)[0], 0.5F);
  EXPECT_EQ(phi.leaf(0)[2], 0.0F);          // reached by contacts only: no material, and φ says so
  EXPECT_TRUE(std::isnan(phi.leaf(0)[3]));  // not active: the background stays
  EXPECT_FALSE(in.noted(2, Reason::no_material));
}

TEST(FieldStages, RatiosAreUndefinedWithoutMaterial) {
  FakeInput in(registry.default_settings());
  in.set("volume", 0, {0.5, 0.25, 0});
  for (int c = 0; c < 3; ++c) in.set("volume velocity", c, {1.0 + c, -2, 0});
  const SparseField u = in.compute(*registry.find("velocity"));
  EXPECT_EQ(u.leaf(0, 0)[0], 2.0F);
  EXPECT_EQ(u.leaf(0, 2)[0], 6.0F);
  EXPECT_EQ(u.leaf(0, 1)[1], -8.0F);
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isnan(u.leaf(0, c)[2]));
  EXPECT_TRUE(in.noted(2, Reason::no_material));
  EXPECT_FALSE(in.noted(0, Reason::no_material));
  EXPECT_FALSE(in.noted(3, Reason::no_material));
}

// T - (c²/12) L:L with c = 6: 3 L:L. Where that is negative there is no temperature.
TEST(FieldStages, CorrectedTemperature) {
  FakeInput in(settings_with(registry, {{"temperature", "mode", "one_pass_corrected"}}));
  in.set("volume", 0, {1, 1, 1});
  in.set("volume velocity fluctuation one_pass", 0, {10, 1, 5});
  SparseField& l = in.add_field("velocity_gradient", 9);
  for (int c = 0; c < 9; ++c)
    for (int v : {0, 1, 2}) l.leaf(0, c)[v] = 0;
  l.leaf(0, 1)[0] = 1;
  l.leaf(0, 3)[0] = -1;
  l.leaf(0, 1)[1] = 1;
  l.leaf(0, 8)[2] = std::numeric_limits<float>::quiet_NaN();
  const SparseField t = in.compute(*registry.find("temperature"));
  EXPECT_EQ(t.leaf(0)[0], 4.0F);
  EXPECT_TRUE(std::isnan(t.leaf(0)[1]));
  EXPECT_TRUE(in.noted(1, Reason::negative_temperature));
  EXPECT_TRUE(std::isnan(t.leaf(0)[2]));
  EXPECT_FALSE(in.noted(2, Reason::negative_temperature));  // the gradient has given its own reason
}

// Divided by what is left of the variance, the gradient part taken off before. Below a thousandth nothing is left.
TEST(FieldStages, WithoutSelfWeight) {
  FakeInput in(settings_with(
      registry, {{"temperature", "mode", "one_pass_corrected"}, {"temperature", "self_weight", "corrected"}}));
  in.set("volume", 0, {1, 1, 0});
  in.set("volume velocity fluctuation one_pass", 0, {10, 1e-6, 0});
  in.set("volume velocity freedom one_pass", 0, {0.5, 9e-4, 0});
  SparseField& l = in.add_field("velocity_gradient", 9);
  for (int c = 0; c < 9; ++c)
    for (int v : {0, 1, 2}) l.leaf(0, c)[v] = c == 1 ? 1 : 0;
  const SparseField t = in.compute(*registry.find("temperature"));
  EXPECT_EQ(t.leaf(0)[0], (10.0F - 3) / 0.5F);
  EXPECT_TRUE(std::isnan(t.leaf(0)[1]));
  EXPECT_TRUE(in.noted(1, Reason::lone_particles));
  EXPECT_FALSE(in.noted(1, Reason::no_material));
  EXPECT_TRUE(std::isnan(t.leaf(0)[2]));
  EXPECT_TRUE(in.noted(2, Reason::no_material));
  EXPECT_FALSE(in.noted(2, Reason::lone_particles));
}

// The spin's own gradient is taken off its variance.
TEST(FieldStages, CorrectedSpinFluctuation) {
  FakeInput in(settings_with(registry, {{"rotational_fluctuation", "mode", "one_pass_corrected"}}));
  in.set("volume", 0, {1, 1, 1});
  in.set("volume angular velocity fluctuation one_pass", 0, {10, 1, 5});
  SparseField& l = in.add_field("angular_velocity_gradient", 9);
  for (int c = 0; c < 9; ++c)
    for (int v : {0, 1, 2}) l.leaf(0, c)[v] = c == 5 && v < 2 ? 1 : 0;
  const SparseField w = in.compute(*registry.find("rotational_fluctuation"));
  EXPECT_EQ(w.leaf(0)[0], 7.0F);
  EXPECT_TRUE(std::isnan(w.leaf(0)[1]));
  EXPECT_TRUE(in.noted(1, Reason::negative_temperature));
  EXPECT_EQ(w.leaf(0)[2], 5.0F);
}

TEST(FieldStages, KineticStressIsSymmetric) {
  FakeInput in(registry.default_settings());
  const MomentPtr m = moments_of(registry, "kinetic_stress", registry.default_settings()).at(0);
  for (int c = 0; c < 6; ++c) in.set(m->name, c, {1.0 + c, 0, 0});
  const SparseField s = in.compute(*registry.find("kinetic_stress"));
  const float expected[9] = {1, 2, 3, 2, 4, 5, 3, 5, 6};
  for (int c = 0; c < 9; ++c) EXPECT_EQ(s.leaf(0, c)[0], expected[c]) << c;
}

TEST(FieldStages, StressIsTheSum) {
  FakeInput in(registry.default_settings());
  SparseField& contact = in.add_field("contact_stress", 9);
  SparseField& kinetic = in.add_field("kinetic_stress", 9);
  for (int c = 0; c < 9; ++c) {
    contact.leaf(0, c)[1] = static_cast<float>(c);
    kinetic.leaf(0, c)[1] = -0.25F;
  }
  const SparseField s = in.compute(*registry.find("stress"));
  for (int c = 0; c < 9; ++c) EXPECT_EQ(s.leaf(0, c)[1], static_cast<float>(c) - 0.25F);
}

TEST(FieldStages, FramesAreTheSamples) {
  FakeInput in(registry.default_settings());
  const SparseField f = in.compute(*registry.find("frames"));
  EXPECT_EQ(f.leaf(0)[0], 2.0F);
  EXPECT_EQ(f.leaf(0)[1], 1.0F);
}

}  // namespace
}  // namespace grainvdb::testing::stages_test
