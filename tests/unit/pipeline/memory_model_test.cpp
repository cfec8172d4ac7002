#include "grainvdb/memory_model.hpp"

#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb::memory_model_test {
namespace {

Pipeline pipeline_of(const std::vector<std::string>& fields) {
  Pipeline p;
  p.voxel = 1;
  p.cutoff = 3;
  p.fields = fields;
  p.limits.frames_in_flight = 3;
  p.stages = StageRegistry::standard().default_settings();
  return p;
}

MemoryModel model_of(const std::vector<std::string>& fields, std::size_t window = 0, std::size_t step = 0) {
  Pipeline p = pipeline_of(fields);
  p.window = window;
  p.window_step = step;
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
  m.per_tracer = 300;
  EXPECT_DOUBLE_EQ(m.peak({5, 4, 1.5, 11, 2}), 1000 + 3 * (5 * 115 + 4 * 230) + 77 + 600);
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

TEST(MemoryModel, CountsTheCopyOfTracersInReducedUnits) {
  Pipeline p = pipeline_of({});
  p.trace.emplace();
  p.trace->record = {"phi", "velocity"};
  const MemoryModel plain = memory_model(make_plan(p), p);
  p.reduced = ReducedUnits{1, 1, 1};
  const MemoryModel reduced = memory_model(make_plan(p), p);
  constexpr double holes = 1.1;  // of the allocator
  // Place, displacement, strain, Co, K and stop time; image; stop; four components of fields.
  EXPECT_NEAR(reduced.per_tracer - plain.per_tracer, holes * ((3 + 3 + 4) * 8 + 3 * 4 + 1 + 4 * 4), 1e-9);
  EXPECT_EQ(reduced.per_voxel, plain.per_voxel);
}

// Runs side by side have one program, and the frames that lie between the first and the last of them.
TEST(MemoryModel, KnowsWhatRunsSideBySideShare) {
  const MemoryModel m = model_of({"contact_stress"});
  constexpr double holes = 1.1;
  EXPECT_DOUBLE_EQ(m.per_particle_read, holes * (8 + 3 * 8 + 8));  // id, place, radius
  EXPECT_DOUBLE_EQ(m.per_contact_read, holes * (2 * 8 + 3 * 8));   // ids, force
  EXPECT_DOUBLE_EQ(m.more_than_sum(1, 10, 20), 3 * (10 * m.per_particle_read + 20 * m.per_contact_read));
  EXPECT_DOUBLE_EQ(m.more_than_sum(3, 10, 20), m.more_than_sum(1, 10, 20) - 2 * m.program);
  EXPECT_THAT(to_string_of_all(m, 3), ::testing::HasSubstr("the sum of all 3 - 2 x 50 MB + 3 x [P 44 + C 44]"));
}

TEST(MemoryModel, KnowsOfTracers) {
  Pipeline p = pipeline_of({"phi", "velocity"});
  const MemoryModel none = memory_model(make_plan(p), p);
  EXPECT_EQ(none.per_tracer, 0);
  EXPECT_THAT(to_string(none), ::testing::Not(::testing::HasSubstr(" N")));
  p.trace.emplace();
  p.trace->strain = false;
  const MemoryModel bare = memory_model(make_plan(p), p);
  p.trace->record = {"velocity", "phi"};
  const MemoryModel recording = memory_model(make_plan(p), p);
  constexpr double holes = 1.1;
  EXPECT_NEAR(recording.per_tracer - bare.per_tracer, holes * 4 * 4, 1e-9);
  EXPECT_GT(bare.per_tracer, 118 + 93);
  EXPECT_NEAR(bare.per_voxel - none.per_voxel, holes * 11.7e3 / 512, 0.1);
  EXPECT_THAT(to_string(bare), ::testing::HasSubstr(" N bytes"));
  EXPECT_THAT(symbols(bare), ::testing::HasSubstr("N tracers"));
  p.trace->through = TraceSpec::Through::frames;
  p.trace->interpolation = Interpolation::tricubic;
  p.window = 1;
  Pipeline untraced = p;
  untraced.trace.reset();
  EXPECT_NEAR(memory_model(make_plan(p), p).per_voxel - memory_model(make_plan(untraced), untraced).per_voxel,
              holes * 2 * 21.3e3 / 512, 0.1);
}

// The forces on the particles are read, and gone before there are values.
TEST(MemoryModel, KnowsOfTheForcesThatCorrectContacts) {
  Pipeline p = pipeline_of({"contact_stress"});
  p.input.contacts.half_step.emplace();
  const MemoryModel corrected = memory_model(make_plan(p), p);
  constexpr double holes = 1.1;
  EXPECT_NEAR(corrected.per_particle - model_of({"contact_stress"}).per_particle, holes * (3 * 8 + 8), 1e-9);  // mass
}

// Over planes nothing is bucketed: a particle has the index and number of its images, before and after sorting, and a
// copy of its values about their mean; a contact its two halves and their values.
TEST(MemoryModel, KnowsOfSumsOverPlanes) {
  Pipeline p = pipeline_of({"phi"});
  p.planes = Planes{2, 1};
  constexpr double holes = 1.1;
  const MemoryModel phi = memory_model(make_plan(p), p);
  EXPECT_DOUBLE_EQ(phi.per_particle, holes * ((8 + 3 * 8 + 8) + 2 * 8));
  EXPECT_DOUBLE_EQ(phi.per_particle_image, holes * (2 * (8 + 4) + 4));
  p.fields = {"contact_stress"};
  const MemoryModel stress = memory_model(make_plan(p), p);
  EXPECT_DOUBLE_EQ(stress.per_contact, holes * 2 * (9 + 9) * 8);
  EXPECT_EQ(stress.per_contact_image, 0);
  EXPECT_THAT(to_string(stress), ::testing::HasSubstr(" + C 317]"));
}

// Along the planes there is one period of a voxel, which images do not count.
TEST(MemoryModel, CountsImagesAlongTheNormalOfPlanes) {
  Pipeline p = pipeline_of({"phi"});
  Lattice lattice(1, {});
  lattice.set_periods({{0, 0, 0}, {1, 1, 12}, {true, true, true}});
  p.planes = Planes{2, 1};
  EXPECT_DOUBLE_EQ(images_per_particle(lattice, p), 1 + 2 * 3.0 / 12);
}

TEST(MemoryModel, CountsContactPointsOfWalls) {
  constexpr double holes = 1.1;
  Pipeline p = pipeline_of({"wall_force"});
  p.input.wall_contacts.files = {"walls"};
  const MemoryModel walls = memory_model(make_plan(p), p);
  EXPECT_NEAR(walls.per_contact_read, holes * (2 * 8 + 3 * 8 + 3 * 8), 1e-9);
  EXPECT_GT(walls.per_contact, 2 * (9 + 3) * 8);  // half branches and their values
}

}  // namespace
}  // namespace grainvdb::memory_model_test
