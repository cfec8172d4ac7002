// What batch systems and programs ask of a run: estimates before it, and progress, warnings and errors they can parse.
#include <gmock/gmock.h>

#include "cli/example_dumps.hpp"
#include "cli/json_lines.hpp"

namespace grainvdb::test::batch_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(DryRun, EstimatesAndWritesNothing) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml", "--dry-run", "-o", "out"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("would use 3 of 3 frames\n"), HasSubstr("step 0 alone: "),
                                HasSubstr(" active voxels\nall frames: about "), HasSubstr(" MB by the formula")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(DryRun, FailsAsTheRunWould) {
  const Folder folder;
  write_example(folder);
  folder.write("frames/dump0.txt", dump_text(0, "id type x y z"));
  const CommandResult dry = run_command({"run", "p.yaml", "--dry-run"}, folder.path());
  const CommandResult wet = run_command({"run", "p.yaml"}, folder.path());
  EXPECT_EQ(dry.exit_code, 2);
  EXPECT_EQ(dry.err, wet.err);
}

TEST(DryRun, PassesOverABadFrameWhereTheInputSaysSo) {
  const Folder folder;
  write_example(folder);
  folder.write("frames/dump0.txt", dump_text(0, "id type x y z"));
  const CommandResult result =
      run_command({"run", "p.yaml", "--dry-run", "--set", "input.on_error=skip_frame"}, folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("step 100 alone: "));
}

TEST(JsonLog, TellsProgressAndWarnings) {
  const Folder folder;
  write_example(folder);
  folder.write("frames/dump100.txt", dump_text(100, "id type x y z"));
  const CommandResult result =
      run_command({"run", "p.yaml", "--log-json", "-q", "--set", "input.on_error=skip_frame"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const std::vector<json> events = json_lines(result.err);
  ASSERT_GE(events.size(), 3U);
  EXPECT_EQ(events.front()["event"], "progress");
  EXPECT_EQ(events.front()["frames_done"], 1);
  EXPECT_EQ(events[events.size() - 2]["frames_done"], 3);
  EXPECT_EQ(events.back()["event"], "warning");
  EXPECT_THAT(events.back()["message"].get<std::string>(), HasSubstr("left out step 100"));
}

TEST(JsonLog, TellsErrorsByTheirParts) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml", "--log-json", "--set", "kernel.cutof=1"}, folder.path());
  EXPECT_EQ(result.exit_code, 1);
  const std::vector<json> events = json_lines(result.err);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0]["event"], "error");
  EXPECT_EQ(events[0]["kind"], "config");
  EXPECT_EQ(events[0]["exit_code"], 1);
}

TEST(ProgressFile, HoldsTheLastProgress) {
  const Folder folder;
  write_example(folder);
  const CommandResult result = run_command({"run", "p.yaml", "-q", "--progress-file", "now.json"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json now = json::parse(read_file(folder / "now.json"));
  EXPECT_EQ(now["frames_done"], 3);
  EXPECT_EQ(now["frames_total"], 3);
  EXPECT_EQ(now["seconds_left"], 0);
}

TEST(ProgressFile, ThatCannotBeWrittenEndsTheRun) {
  const Folder folder;
  write_example(folder);
  folder.write("file", "in the way");
  EXPECT_EQ(run_command({"run", "p.yaml", "--progress-file", "file/now.json"}, folder.path()).exit_code, 3);
}

}  // namespace
}  // namespace grainvdb::test::batch_test
