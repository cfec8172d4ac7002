#include "grainvdb/memory_model.hpp"

#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb {
namespace {

MemoryModel model_of(const std::vector<std::string>& fields, std::size_t window = 0, std::size_t step = 0) {
  Pipeline p;
  p.voxel = 1;
  p.cutoff = 3;
  p.fields = fields;
  p.window = window;
  p.window_step = step;
  p.limits.frames_in_flight = 3;
  p.stages = StageRegistry::standard().default_settings();
  return memory_model(make_plan(p), p);
}

TEST(MemoryModel, AddsWhatFramesAndVoxelsTake) {
  MemoryModel m;
  m.frames_in_flight = 3;
  m.fixed = 1000;
  m.per_particle = 100;
  m.per_particle_image = 10;
  m.per_contact = 200;
  m.per_contact_image = 20;
  m.per_voxel = 7;
  EXPECT_DOUBLE_EQ(m.peak({5, 4, 1.5, 11}), 1000 + 3 * (5 * 115 + 4 * 230) + 77);
}

TEST(MemoryModel, CountsColumnsSumsAndFields) {
  const MemoryModel phi = model_of({"phi"}), velocity = model_of({"phi", "velocity"});
  // A vector more in every frame, as column and as value; in the sums, and as fields.
  constexpr double holes = 1.1;  // of the allocator
  EXPECT_NEAR(velocity.per_particle - phi.per_particle, holes * (3 * 8 + 3 * 8), 1e-9);
  EXPECT_NEAR(velocity.per_voxel - phi.per_voxel, holes * (3 * 8 + 3 * 4), 1.5);
  EXPECT_EQ(phi.per_contact, 0);
  EXPECT_GT(model_of({"contact_stress"}).per_contact, 2 * (9 + 9) * 8);
}

TEST(MemoryModel, KnowsOfSharedPartsOfWindows) {
  const double one = model_of({"phi"}, 8).per_voxel, sliding = model_of({"phi"}, 8, 2).per_voxel;
  EXPECT_GT(sliding - one, 4 * 2 * 8);  // four parts of a sum and a count of samples
}

}  // namespace
}  // namespace grainvdb
