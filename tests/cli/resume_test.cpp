// Runs that are killed while they work.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::resume_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int frame_count = 40;

void write_many(const Folder& folder) {
  write_example(folder);
  std::filesystem::remove_all(folder / "frames");
  for (int step = 0; step < frame_count; ++step) {
    folder.write("frames/dump" + std::to_string(step) + ".txt", dump_text(step));
    folder.write("frames/contacts" + std::to_string(step) + ".txt", contacts_text(step));
  }
}

/// Runs, and kills what runs so often at most, until a run comes to its end.
void run_with_kills(const Folder& folder, const std::vector<std::string>& words, int most) {
  std::mt19937 draw(7);
  for (int kills = 0;; ++kills) {
    const std::chrono::microseconds wait(std::uniform_int_distribution<int>(5'000, 80'000)(draw));
    const CommandResult result = run_command(words, folder.path(), {}, [&](pid_t process) {
      if (kills >= most) return;
      std::this_thread::sleep_for(wait);
      kill(process, SIGKILL);
    });
    if (result.exit_code == 0) return;
    ASSERT_EQ(result.exit_code, 128 + SIGKILL) << result.err;
  }
}

TEST(Resume, AfterKillsGivesTheSameBytes) {
  const Folder folder;
  write_many(folder);
  const std::vector<std::vector<std::string>> cases{
      {"--set", "output.fields=[phi,stress]"},
      {"--set", "output.fields=[velocity,temperature]", "--set", "average.window=none", "--set",
       "output.formats=[hdf5,vdb]"},
      {"--set", "output.fields=[phi]", "--set", "measure.plane_profile.fields=[phi,stress]"}};
  for (const auto& settings : cases) {
    std::vector<std::string> words{"run", "p.yaml"};
    words.insert(words.end(), settings.begin(), settings.end());
    std::vector<std::string> whole = words;
    whole.insert(whole.end(), {"--output", "whole"});
    ASSERT_EQ(run_command(whole, folder.path()).exit_code, 0);
    words.insert(words.end(), {"--output", "resumed", "--resume", "--checkpoint-interval", "0"});
    run_with_kills(folder, words, 6);
    const std::vector<std::string> names = folder.names_in("whole");
    EXPECT_EQ(folder.names_in("resumed"), names);
    for (const std::string& name : folder.results_in("whole"))
      EXPECT_TRUE(read_file(folder / ("whole/" + name)) == read_file(folder / ("resumed/" + name))) << name;
  }
}

TEST(Resume, SaysWhereItWentOn) {
  const Folder folder;
  write_many(folder);
  const std::vector<std::string> words{"run", "p.yaml", "--resume", "--checkpoint-interval", "0"};
  const CommandResult stopped = run_command(words, folder.path(), {}, [&](pid_t process) {
    while (!std::filesystem::exists(folder / "output/.grainvdb-checkpoint/state")) std::this_thread::yield();
    kill(process, SIGTERM);
  });
  if (stopped.exit_code == 0) GTEST_SKIP() << "it was done before it could be stopped";
  ASSERT_EQ(stopped.exit_code, 128 + SIGTERM) << stopped.err;
  const CommandResult refused = run_command({"run", "p.yaml", "--resume", "--set", "lattice.voxel=1"}, folder.path());
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("output/.grainvdb-checkpoint"), HasSubstr("had another pipeline"),
                                 HasSubstr("voxel: 0.5"), HasSubstr("voxel: 1")));
  const CommandResult result = run_command(words, folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("resumed: "));
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "run.json"));
}

TEST(Resume, LeavesNothingWhereItIsNotAskedFor) {
  const Folder folder;
  write_example(folder);
  ASSERT_EQ(run_command({"run", "p.yaml"}, folder.path()).exit_code, 0);
  EXPECT_THAT(folder.names_in("output"), ElementsAre("fields.hdf", "run.json"));
  EXPECT_EQ(run_command({"run", "p.yaml", "--checkpoint-interval", "5"}, folder.path()).exit_code, 1);
}

}  // namespace
}  // namespace grainvdb::test::resume_test
