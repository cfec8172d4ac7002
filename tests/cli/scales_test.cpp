#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::scales_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> scales{"--set", "scales.cutoff=[1.5,2]", "--set", "scales.voxel=[0.5,1]"};

TEST(Scales, GiveTheBytesOfSeparateRuns) {
  const Folder folder;
  write_example(folder);
  std::vector<std::string> words{"run", "p.yaml", "--output", "all", "--set", "output.fields=[phi,stress]"};
  words.insert(words.end(), scales.begin(), scales.end());
  const CommandResult result = run_command(words, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("cutoff 1.5, voxel 0.5\n"));
  EXPECT_THAT(folder.names_in("all"), ElementsAre("c1.5_h0.5", "c2.0_h1.0"));
  const auto expect_same = [&](const std::string& cutoff, const std::string& voxel) {
    const CommandResult alone =
        run_command({"run", "p.yaml", "--output", "alone", "--set", "output.fields=[phi,stress]", "--set",
                     "kernel.cutoff=" + cutoff, "--set", "lattice.voxel=" + voxel},
                    folder.path());
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    EXPECT_TRUE(read_file(folder / "alone/fields.hdf") ==
                read_file(folder / ("all/c" + cutoff + "_h" + voxel + "/fields.hdf")))
        << cutoff;
  };
  expect_same("1.5", "0.5");
  expect_same("2.0", "1.0");
}

/// The example at two voxels, with a section `trace` of which this is the rest.
std::vector<std::string> traced(const Folder& folder, const std::string& command, const std::string& inside) {
  write_example(folder);
  folder.write("p.yaml", pipeline_text() + "trace:\n  seeds: {points: [[1, 1, 1.25], [2, 2, 2.75]]}\n" + inside);
  return {command, "p.yaml", "--output", "all", "--set", "scales.cutoff=[1.5,1.5]", "--set", "scales.voxel=[0.25,0.5]"};
}

// At c/h = 6 tracers alone would look at the first frame before others need it.
TEST(Scales, HaveTracersOfTheirOwn) {
  const Folder folder;
  const CommandResult result = run_command(traced(folder, "trace", "  steps: 4\n  record: [phi]\n"), folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const std::string voxel : {"0.25", "0.5"}) {
    const std::string histories = "all/c1.5_h" + voxel;
    EXPECT_THAT(folder.names_in(histories), ElementsAre("run.json", "tracers.h5", "tracers.xmf2"));
    const CommandResult alone =
        run_command({"trace", "p.yaml", "--output", "alone" + voxel, "--set", "lattice.voxel=" + voxel}, folder.path());
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    EXPECT_TRUE(read_file(folder / ("alone" + voxel + "/tracers.h5")) ==
                read_file(folder / (histories + "/tracers.h5")))
        << voxel;
  }
}

TEST(Scales, WarnOfTheHistoriesOfEach) {
  const Folder folder;
  std::vector<std::string> words = traced(folder, "run", "  through: frames\n");
  words.insert(words.end(), {"-q", "--set", "average.window=1", "--set", "input.dt=0.01"});
  const CommandResult result = run_command(words, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("warning: at cutoff 1.5, voxel 0.25: histories through frames are not"),
                                HasSubstr("warning: at cutoff 1.5, voxel 0.5: histories through frames are not")));
}

TEST(Scales, AreEachLookedAtByValidateAndGraph) {
  const Folder folder;
  write_example(folder);
  const auto with = [&](const std::string& command, std::vector<std::string> more) {
    std::vector<std::string> words{command, "p.yaml"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words, folder.path());
  };
  EXPECT_EQ(with("validate", scales).exit_code, 0);
  // The second voxel does not divide the periodic box; the second kernel falls between the voxels.
  const CommandResult voxel = with("validate", {"--set", "scales.cutoff=[1.5,2]", "--set", "scales.voxel=[0.5,0.7]"});
  EXPECT_EQ(voxel.exit_code, 1);
  const CommandResult kernel =
      with("validate", {"--no-input", "--set", "scales.cutoff=[1.5,0.5]", "--set", "scales.voxel=[0.5,1]"});
  EXPECT_EQ(kernel.exit_code, 1);
  const CommandResult graph = with("graph", scales);
  EXPECT_THAT(graph.out,
              AllOf(HasSubstr("cutoff 1.5, voxel 0.5\npipeline p.yaml\n"), HasSubstr("cutoff 2.0, voxel 1.0\n"),
                    HasSubstr("peak memory of all scales together: the sum of all 2 - 1 x 50 MB + ")));
  EXPECT_THAT(with("graph", {}).out, Not(HasSubstr("all scales")));
}

TEST(Scales, RefuseWhatCannotBe) {
  const Folder folder;
  write_example(folder);
  const auto error_of = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"run", "p.yaml"};
    words.insert(words.end(), scales.begin(), scales.end());
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(words, folder.path());
    EXPECT_EQ(result.exit_code, 1);
    return result.err;
  };
  EXPECT_THAT(error_of({"--set", "scales.voxel=[1]"}), HasSubstr("do not make pairs"));
  EXPECT_THAT(error_of({"--set", "scales.cutoff=[2,2]", "--set", "scales.voxel=[1,1]"}), HasSubstr("a pair twice"));
  EXPECT_THAT(error_of({"--resume"}), HasSubstr("neither be resumed"));
  EXPECT_THAT(error_of({"--follow", "--timeout", "1"}), HasSubstr("nor followed"));
  EXPECT_THAT(error_of({"--set", "average.until.field=phi", "--set", "average.until.error=0.1", "--set",
                        "average.until.quantile=0.9"}),
              HasSubstr("both scales and average.until"));
  EXPECT_THAT(error_of({"--set", "trace.seeds.points=[[1, 1, 1]]", "--set", "trace.steps=4", "--set",
                        "trace.neighbourhood=always"}),
              HasSubstr("both scales and trace.neighbourhood: always"));
}

}  // namespace
}  // namespace grainvdb::test::scales_test
