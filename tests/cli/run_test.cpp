#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::test::run_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Run, WritesTheFieldsAndSaysWhere) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "run.json"));
  EXPECT_EQ(read_file(folder / "output/fields.hdf").substr(1, 3), "HDF");
  // The kernel covers the box of 8³ voxels.
  EXPECT_THAT(result.out, AllOf(HasSubstr("3 frames, 512 active voxels"), HasSubstr("wrote output/fields.hdf"),
                                HasSubstr("paraview output/fields.hdf"), HasSubstr("h5py"), HasSubstr("time:")));
  EXPECT_EQ(result.err, "");  // no progress, as this is no terminal
}

// On the sample shear cell: five frames, in two of which half the voxels are certain to 30 %.
TEST(Run, SaysWhereAnAverageStoppedByItself) {
  const Folder folder;
  const auto until = [&](const char* target) {
    return run_command(
        {"run", ::grainvdb::testing::in_repository("pipelines/minimal.yaml"), "--set", "average.blocks=2", "--set",
         std::string("average.until={field: phi, quantile: 0.5, ") + target + "}"},
        folder.path());
  };
  const CommandResult met = until("relative: 0.3");
  ASSERT_EQ(met.exit_code, 0) << met.err;
  EXPECT_THAT(met.out, HasSubstr("stopped by average.until after 2 of 5 frames: phi_error/|phi| in 50 % of voxels"));
  EXPECT_EQ(met.err, "");
  const CommandResult missed = until("error: 1e-12");
  ASSERT_EQ(missed.exit_code, 0) << missed.err;
  EXPECT_THAT(missed.out, HasSubstr("average.until was not met after 5 of 5 frames"));
  EXPECT_THAT(missed.err, HasSubstr("warning: average.until was not met after all 5 frames"));
  const CommandResult refused = until("error: 1, relative: 1");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("average.until"));
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
  EXPECT_THAT(folder.names_in("a/b"), ElementsAre("fields.hdf", "run.json"));
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
  // The fields, the sidecar, one VDB file per output time and run.json.
  EXPECT_EQ(folder.names_in("output").size(), 6U);
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
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "fields.vdb", "run.json"));
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
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "run.json"));
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
}  // namespace grainvdb::test::run_test
