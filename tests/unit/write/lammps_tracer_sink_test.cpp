#include "write/lammps_tracer_sink.hpp"

#include <gmock/gmock.h>

#include "grainvdb/frame_source.hpp"
#include "unit/write/tracer_scene.hpp"

namespace grainvdb::lammps_tracer_sink_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string written(const TracerScene& scene, const TracerLayout& layout, const TemporaryFolder& folder) {
  const auto sink = make_lammps_tracer_sink(folder.path());
  sink->begin(layout);
  for (int t = 0; t < scene.samples; ++t) sink->write(scene.sample(t));
  sink->commit(some_provenance());
  EXPECT_THAT(folder.names(), ElementsAre("tracers.dump"));
  EXPECT_THAT(sink->files(), ElementsAre(folder / "tracers.dump"));
  return read_file(folder / "tracers.dump");
}

TEST(LammpsTracerSink, WritesSnapshotsThatLammpsReads) {
  const TemporaryFolder folder;
  TracerScene scene;
  scene.tracers = 2;
  scene.samples = 2;
  scene.optional_columns = false;
  scene.fields.resize(1);
  EXPECT_EQ(written(scene, scene.layout(), folder), R"(ITEM: UNITS
si
ITEM: TIME
0.5
ITEM: TIMESTEP
1000
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp ff pp
-1 3
0 0.1
0.5 10.5
ITEM: ATOMS id type x y z ix iy iz phi displacement_1 displacement_2 displacement_3 stop
10 1 31.654383582688826 33.19638534539566 34.66987164671943 0 0 0 -141.42842 44.74371464239419 45.8475735453906 46.92547282660026 0
17 1 31.670175244226233 33.21144381083123 34.68429039204925 0 0 0 -141.43196 44.75488800120049 45.858477951192405 46.93612681080534 0
ITEM: TIME
0.6
ITEM: TIMESTEP
1100
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp ff pp
-1 3
0 0.1
0.5 10.5
ITEM: ATOMS id type x y z ix iy iz phi displacement_1 displacement_2 displacement_3 stop
10 1 31.65635797118803 33.1982680271125 34.67167431780588 0 0 0 -141.42886 44.745111464829314 45.8489367379441 46.92680470690499 0
17 1 31.672148648299817 33.213325638966054 34.68609231377902 -1 0 1 nan 44.75628447492039 45.859840819610355 46.93745838879647 1
)");
}

TEST(LammpsTracerSink, NamesTheColumnsOfVectorsAndTensors) {
  const TemporaryFolder folder;
  TracerScene scene;
  scene.fields = {meta_of("velocity", 3, 0), meta_of("angular_velocity", 3, 0), meta_of("principal_stress", 3, 0),
                  meta_of("stress", 9, 0)};
  EXPECT_THAT(written(scene, scene.layout(), folder),
              HasSubstr("ITEM: ATOMS id type x y z ix iy iz vx vy vz omegax omegay omegaz principal_stress_1 "
                        "principal_stress_2 principal_stress_3 stress_xx stress_xy stress_xz stress_yx stress_yy "
                        "stress_yz stress_zx stress_zy stress_zz displacement_1 displacement_2 displacement_3 strain "
                        "courant gradient_number stop\n"));
}

TEST(LammpsTracerSink, LeavesOutUnitsAndTimesThatTheDumpHasNot) {
  const TemporaryFolder folder;
  const TracerScene scene;
  TracerLayout layout = scene.layout();
  layout.time_unit = "step";
  layout.unit_system = "unspecified";
  EXPECT_THAT(written(scene, layout, folder),
              ::testing::AllOf(::testing::StartsWith("ITEM: TIMESTEP\n1000\n"), Not(HasSubstr("ITEM: TIME\n"))));
}

TEST(LammpsTracerSink, IsReadBackExactlyByOurOwnReader) {
  const TemporaryFolder folder;
  const TracerScene scene;
  written(scene, scene.layout(), folder);
  InputSpec input;
  input.particles = {folder / "tracers.dump"};
  input.radius = 1.0;
  const auto source = open_dumps(input);
  ASSERT_EQ(source->frames().size(), 3U);
  EXPECT_EQ(source->units().name, "si");
  for (int t = 0; t < 3; ++t) {
    const Frame frame = source->read(static_cast<std::size_t>(t), Column::velocity);
    EXPECT_EQ(frame.step, TracerScene::step(t));
    EXPECT_EQ(frame.time, TracerScene::time(t));
    EXPECT_EQ(frame.box, scene.layout().box);
    EXPECT_EQ(frame.particles.id, scene.layout().id);
    EXPECT_EQ(frame.particles.position, scene.sample(t).position);
    for (std::size_t i = 0; i < scene.tracers; ++i)
      for (int a = 0; a < 3; ++a)
        EXPECT_EQ(static_cast<float>(frame.particles.velocity[static_cast<std::size_t>(a)][i]),
                  TracerScene::field_value(1, a, i, t));
  }
}

}  // namespace
}  // namespace grainvdb::lammps_tracer_sink_test
