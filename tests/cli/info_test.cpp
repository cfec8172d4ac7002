#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::test::info_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Info, SaysWhatIsInTheDumps) {
  const Folder folder;
  write_dumps(folder);
  const CommandResult result = run_command({"info", "frames/dump*.txt"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("frames: 3\n"), HasSubstr("first step 0, 64 particles"), HasSubstr("last  step 200"),
                    HasSubstr("spacing: 100 steps"), HasSubstr("particles: 64\n"),
                    HasSubstr("box: x 0 ... 4 periodic, y 0 ... 4 periodic, z 0 ... 4 periodic\n"),
                    HasSubstr("columns: id type x y z vx vy vz radius mass (10)"), HasSubstr("units: unspecified")));
  EXPECT_THAT(result.out, Not(HasSubstr("contact columns")));
  const auto bytes = std::to_string(dump_text(0).size() + dump_text(100).size() + dump_text(200).size());
  EXPECT_THAT(result.out, AllOf(HasSubstr("files: 3, " + bytes + " bytes"), Not(HasSubstr("gaps"))));
}

TEST(Info, TellsGapsBetweenFrames) {
  const Folder folder;
  write_dumps(folder);
  folder.write("frames/dump400.txt", dump_text(400));
  folder.write("frames/dump500.txt", dump_text(500));
  const CommandResult result = run_command({"info", "frames/dump*.txt"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("spacing: 100 ... 200 steps\ngaps: 1, after step 200\n"));
}

TEST(Info, ShowsContactsTimesAndEveryFrame) {
  const Folder folder;
  write_dumps(folder);
  const CommandResult result = run_command(
      {"info", "frames/dump0.txt", "frames/dump200.txt", "--contacts", "frames/contacts*.txt", "--dt", "0.5", "--list"},
      folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("frames: 2\n"), HasSubstr("step 200, time 100, 64 particles  frames/dump200.txt"),
                    HasSubstr("contact columns: id1 id2 fx fy fz (5)")));
}

TEST(Info, ShowsContactsWithWalls) {
  const Folder folder;
  const std::string sample = grainvdb::testing::in_repository("sample_dumps/formats/");
  const CommandResult meshes = run_command(
      {"info", sample + "mesh_grains_*.dump", "--wall-contacts", sample + "mesh_walls_*.dump"}, folder.path());
  ASSERT_EQ(meshes.exit_code, 0) << meshes.err;
  EXPECT_THAT(meshes.out, AllOf(HasSubstr("\nwall contact columns: c_wl[1] c_wl[2] "), HasSubstr("c_wl[15] (15)\n"),
                                HasSubstr("files: 4, "), Not(HasSubstr("\ncontact columns"))));
  const CommandResult both =
      run_command({"info", sample + "mesh_mercury.data", "--periodic", "none", "--contacts",
                   sample + "mesh_mercury.fstat", "--wall-contacts", sample + "mesh_mercury.fstat"},
                  folder.path());
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_THAT(both.out,
              AllOf(HasSubstr("\ncontact columns: id1 id2 fx fy fz (5)\n"),
                    HasSubstr("\nwall contact columns: id fx fy fz cx cy cz (7)\n"), HasSubstr("files: 2, ")));
}

TEST(Info, NamesTheUnitsOfTheDump) {
  const Folder folder;
  folder.write("d.txt", "ITEM: UNITS\nlj\n" + dump_text(5));
  const CommandResult result = run_command({"info", "d.txt"}, folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("units: lj\n"));
}

TEST(Info, EstimatesAPipelineOnOtherDumps) {
  const Folder folder;
  write_example(folder);
  folder.write("other/d.txt", dump_text(7));
  const CommandResult result = run_command({"info", "other/d.txt", "--pipeline", "p.yaml"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("with p.yaml:\nwould use 1 of 1 frames\nstep 7 alone: "),
                                HasSubstr(" MB by the formula of 'grainvdb graph'")));
}

TEST(Info, EstimatesAPipelineAtItsScales) {
  const Folder folder;
  write_example(folder);
  folder.write("p.yaml", pipeline_text() + "scales: {cutoff: [1.5, 2], voxel: [0.5, 1]}\n");
  const CommandResult result = run_command({"info", "frames/dump*.txt", "--pipeline", "p.yaml"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("with p.yaml, cutoff 1.5, voxel 0.5:\nwould use 3 of 3 frames\n"),
                                HasSubstr("with p.yaml, cutoff 2.0, voxel 1.0:\n")));
}

TEST(Info, RefusesWhatIsNoDump) {
  const Folder folder;
  folder.write("d.txt", "hello\n");
  EXPECT_EQ(run_command({"info", "d.txt"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run_command({"info", "no_such_*"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run_command({"info"}, folder.path()).exit_code, 1);
  EXPECT_EQ(run_command({"info", "d.txt", "--dt", "0"}, folder.path()).exit_code, 1);
  folder.write("good.txt", dump_text(7));
  EXPECT_EQ(run_command({"info", "good.txt", "--pipeline", "no_such.yaml"}, folder.path()).exit_code, 3);
}

}  // namespace
}  // namespace grainvdb::test::info_test
