#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Run, WritesTheFieldsAndSaysWhere) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf"));
  EXPECT_EQ(read_file(folder / "output/fields.hdf").substr(1, 3), "HDF");
  // The kernel covers the box of 8³ voxels.
  EXPECT_THAT(result.out, AllOf(HasSubstr("3 frames, 512 active voxels"), HasSubstr("wrote output/fields.hdf"),
                                HasSubstr("paraview output/fields.hdf"), HasSubstr("h5py"), HasSubstr("time:")));
  EXPECT_EQ(result.err, "");  // no progress, as this is no terminal
}

TEST(Run, ReadsNothingThatIsNotNeeded) {
  const Folder folder;
  write_example(folder);
  std::filesystem::remove_all(folder / "frames");
  for (int step : {0, 100, 200})
    folder.write("frames/dump" + std::to_string(step) + ".txt", dump_text(step, "id x y z radius"));
  const CommandResult result = run_command({"run", "p.yaml", "--set", "output.fields=[phi]"}, folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;  // no velocities, no contact dumps
}

TEST(Run, FramesAndOutputAndThreadsAreObeyed) {
  const Folder folder;
  write_example(folder);
  const auto frames = [&](const std::string& range) {
    const CommandResult result =
        run_command({"run", "p.yaml", "--frames", range, "-o", "a/b", "--threads", "1"}, folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  EXPECT_THAT(frames("::2"), HasSubstr("2 frames,"));
  EXPECT_THAT(frames("1"), HasSubstr("1 frame,"));
  EXPECT_THAT(frames("-2:"), HasSubstr("2 frames,"));
  EXPECT_THAT(folder.names_in("a/b"), ElementsAre("fields.hdf"));
  EXPECT_FALSE(std::filesystem::exists(folder / "output"));
}

TEST(Run, TheResultDoesNotDependOnTheThreads) {
  const Folder folder;
  write_example(folder);
  const auto bytes = [&](const std::string& threads) {
    const CommandResult result = run_command(
        {"run", "p.yaml", "-o", "t" + threads, "--threads", threads, "--set", "output.fields=[stress,temperature]"},
        folder.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_file(folder / ("t" + threads + "/fields.hdf"));
  };
  const std::string one = bytes("1");
  EXPECT_FALSE(one.empty());
  EXPECT_TRUE(one == bytes("2"));
}

TEST(Run, ASeriesSaysHowToOpenIt) {
  const Folder folder;
  write_example(folder);
  const CommandResult result =
      run_command({"run", "p.yaml", "--set", "average.window=1", "--set", "output.formats=[hdf5, vdb]"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("paraview output/fields.xmf2"), HasSubstr("1 more file beside them")));
  EXPECT_EQ(folder.names_in("output").size(), 5U);  // the fields, the sidecar and one VDB file per output time
}

TEST(Run, QuietPrintsNothing) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml", "--quiet"}, folder.path());
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST(Run, OverridesWinOverTheFile) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command(
      {"run", "p.yaml", "--set", "lattice.voxel=1", "--set", "kernel.cutoff=2", "--set=output.formats=[vdb,hdf5]"},
      folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" 64 active voxels"));
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "fields.vdb"));
}

TEST(Run, AFailureLeavesAnEarlierResultAlone) {
  const Folder folder;
  write_example(folder);
  ASSERT_EQ(run_command({"run", "p.yaml"}, folder.path()).exit_code, 0);
  const std::string before = read_file(folder / "output/fields.hdf");
  std::string broken = dump_text(200);
  folder.write("frames/dump200.txt", broken.replace(broken.find("2.5"), 3, "2,5"));
  const CommandResult result = run_command({"run", "p.yaml", "--set", "output.fields=[phi]"}, folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("dump200.txt:"), HasSubstr("2,5")));
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf"));
  EXPECT_TRUE(before == read_file(folder / "output/fields.hdf"));
}

TEST(Run, UndefinedVoxelsAreCountedByReason) {
  const Folder folder;
  write_example(folder);
  // No pressure is enough, so that mu is undefined everywhere.
  const CommandResult result = run_command(
      {"run", "p.yaml", "--set", "output.fields=[mu]", "--set", "stages.pressure.pressure_min=1e9"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("mask: 512 voxels low_pressure (P <= pressure_floor"));
}

}  // namespace
}  // namespace grainvdb::test
