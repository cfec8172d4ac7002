#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
}

}  // namespace
}  // namespace grainvdb::test
