#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::bad_frames_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> skipping{"run", "p.yaml", "--set", "input.on_error=skip_frame", "--set"};

CommandResult run_skipping(const Folder& folder, const std::string& set) {
  std::vector<std::string> words = skipping;
  words.push_back(set);
  return run_command(words, folder.path());
}

// A disk that was full leaves empty files, cut headers and cut rows.
TEST(BadFrames, AreLeftOutAndNamed) {
  const Folder folder;
  write_example(folder);
  folder.write("frames/dump50.txt", "");
  folder.write("frames/dump100.txt", dump_text(100).substr(0, 60));
  folder.write("frames/dump200.txt", dump_text(200).substr(0, 900));
  const CommandResult result = run_skipping(folder, "output.fields=[phi]");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("1 frame,"), HasSubstr("left out: 3 bad frames")));
  EXPECT_THAT(result.err, AllOf(HasSubstr("warning: left out frames/dump50.txt: "),
                                HasSubstr("warning: left out frames/dump100.txt:"),
                                HasSubstr("warning: left out step 200: frames/dump200.txt:")));
  EXPECT_EQ(run_command({"run", "p.yaml", "--set", "output.fields=[phi]"}, folder.path()).exit_code, 2);
}

TEST(BadFrames, MayLackContactsOrHaveBadOnes) {
  const Folder folder;
  write_example(folder);
  std::filesystem::remove(folder / "frames/contacts0.txt");
  std::string text = contacts_text(100);
  folder.write("frames/contacts100.txt", text.replace(text.rfind("-1"), 2, "x1"));
  const CommandResult result = run_skipping(folder, "output.fields=[contact_stress]");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1 frame,"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("left out step 0: "), HasSubstr("no contact dump has timestep 0"),
                                HasSubstr("left out step 100: frames/contacts100.txt:")));
}

// Columns that no frame has are the fault of the pipeline.
TEST(BadFrames, AreNotAll) {
  const Folder folder;
  write_example(folder);
  for (int step : {0, 100, 200}) folder.write("frames/dump" + std::to_string(step) + ".txt", "ITEM: TIME");
  const CommandResult result = run_skipping(folder, "output.fields=[phi]");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("no particle dump in"), HasSubstr("dump0.txt:")));
  for (int step : {0, 100, 200})
    folder.write("frames/dump" + std::to_string(step) + ".txt", dump_text(step, "id x y z radius"));
  EXPECT_EQ(run_skipping(folder, "output.fields=[velocity]").exit_code, 2);
}

TEST(BadFrames, AreNoReasonToCallThePipelineInvalid) {
  const Folder folder;
  write_example(folder);
  std::string text = dump_text(0);
  folder.write("frames/dump0.txt", text.replace(text.find("2.5"), 3, "2,5"));
  EXPECT_EQ(run_command({"validate", "p.yaml"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run_command({"validate", "p.yaml", "--set", "input.on_error=skip_frame"}, folder.path()).exit_code, 0);
}

}  // namespace
}  // namespace grainvdb::test::bad_frames_test
