#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"
#include "cli/json_lines.hpp"

namespace grainvdb::test::tune_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Tune, PrintsATableAndWritesIt) {
  const Folder folder;
  write_example(folder);
  const CommandResult r = run_command({"tune", "p.yaml", "--tolerance", "phi=0.5,velocity=0.5", "--repeats", "1",
                                       "--knobs", "lattice.voxel", "--no-picture"},
                                      folder.path());
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, AllOf(HasSubstr("as it is"), HasSubstr("lattice.voxel="), HasSubstr("\nwrote tune/tune.csv\n")));
  EXPECT_THAT(read_file(folder / "tune/tune.csv"), HasSubstr("\"\",1,"));
}

TEST(Tune, SaysBeforeWhatItWouldTry) {
  const Folder folder;
  write_example(folder);
  const CommandResult r = run_command({"tune", "p.yaml", "--dry-run", "--repeats", "2"}, folder.path());
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, AllOf(HasSubstr("would make at most "), HasSubstr("\nreference: lattice.voxel=0.25"),
                           HasSubstr("\n  as it is\n  lattice.voxel="), HasSubstr("would use 3 of 3 frames\n")));
  EXPECT_FALSE(std::filesystem::exists(folder / "tune"));
  EXPECT_EQ(run_command({"tune", "p.yaml", "--dry-run", "--tolerance", "mu=0.1"}, folder.path()).exit_code, 1);
}

TEST(Tune, LogsItsRunsAndErrors) {
  const Folder folder;
  write_example(folder);
  const CommandResult r = run_command(
      {"tune", "p.yaml", "--log-json", "-q", "--repeats", "1", "--knobs", "frames", "--no-picture"}, folder.path());
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.out, "");
  const auto events = json_lines(r.err);
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events.front()["event"], "progress");
  EXPECT_THAT(events.front()["doing"].get<std::string>(), HasSubstr("run 1 of at most "));
  const auto errors = json_lines(run_command({"tune", "q.yaml", "--log-json"}, folder.path()).err);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0]["kind"], "io");
}

TEST(Tune, RefusesOptionsThatMakeNoSense) {
  const Folder folder;
  write_example(folder);
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--tolerance", "phi"},
                                             {"--tolerance", "mu=0.1"},
                                             {"--knobs", "lattice.vox"},
                                             {"--try", "output.fields=[phi]"}}) {
    std::vector<std::string> arguments{"tune", "p.yaml", "--no-picture"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult r = run_command(arguments, folder.path());
    EXPECT_EQ(r.exit_code, 1) << options[1];
    EXPECT_THAT(r.err, HasSubstr(options[0])) << options[1];
  }
}

TEST(Tune, RefusesSeveralScales) {
  const Folder folder;
  write_example(folder);
  const CommandResult r =
      run_command({"tune", "p.yaml", "--no-picture", "--set", "scales.cutoff=[2.5, 3]", "--set", "scales.voxel=[1, 1]"},
                  folder.path());
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_THAT(r.err, AllOf(HasSubstr("settings are compared at one scale"), HasSubstr("2 scales")));
}

}  // namespace
}  // namespace grainvdb::test::tune_test
