// Runs that begin before their input is complete.
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::follow_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int last_step = 400;

void pause() {
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
}

/// Appends to a file piece by piece, as a simulation does whose buffers fill.
void write_slowly(const std::filesystem::path& file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const std::size_t piece = std::min(text.size() / 3 + 1, text.size() - done);
    std::ofstream(file, std::ios::app | std::ios::binary) << text.substr(done, piece) << std::flush;
    done += piece;
    pause();
  }
}

/// An example without its dumps.
void write_pipeline(const Folder& folder) {
  write_example(folder);
  for (int step : {0, 100, 200}) {
    std::filesystem::remove(folder / ("frames/dump" + std::to_string(step) + ".txt"));
    std::filesystem::remove(folder / ("frames/contacts" + std::to_string(step) + ".txt"));
  }
}

/// What a simulation writes; contacts come first, or only after the grains.
void simulate(const Folder& folder, int first = 0, int last = last_step) {
  for (int step = first; step <= last; step += 100) {
    const std::string number = std::to_string(step);
    const auto grains = [&] { write_slowly(folder / ("frames/dump" + number + ".txt"), dump_text(step)); };
    const auto contacts = [&] { write_slowly(folder / ("frames/contacts" + number + ".txt"), contacts_text(step)); };
    if (step % 200 == 0) contacts();
    grains();
    if (step % 200 != 0) contacts();
  }
}

std::vector<std::string> follow(std::vector<std::string> settings, std::vector<std::string> end) {
  std::vector<std::string> words{"run", "p.yaml", "--follow", "--look-every", "0.05", "--output", "followed"};
  words.insert(words.end(), settings.begin(), settings.end());
  words.insert(words.end(), end.begin(), end.end());
  return words;
}

void expect_plain_result(const Folder& folder, const std::vector<std::string>& settings) {
  std::vector<std::string> words{"run", "p.yaml", "--output", "plain"};
  words.insert(words.end(), settings.begin(), settings.end());
  const CommandResult plain = run_command(words, folder.path());
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(folder.names_in("followed"), folder.names_in("plain"));
  for (const std::string& name : folder.results_in("plain"))
    EXPECT_TRUE(read_file(folder / ("plain/" + name)) == read_file(folder / ("followed/" + name))) << name;
}

TEST(Follow, GivesWhatAPlainRunGives) {
  const std::vector<std::vector<std::string>> cases{
      {"--set", "output.fields=[phi,stress]"},
      {"--set", "output.fields=[phi,velocity]", "--set", "average.window=2"},
      {"--set", "output.fields=[phi,contact_stress]", "--set", "average.window=3", "--set", "average.step=1"}};
  for (const auto& settings : cases) {
    const Folder folder;
    write_pipeline(folder);
    const CommandResult result = run_command(follow(settings, {"--last-step", std::to_string(last_step)}),
                                             folder.path(), {}, [&](pid_t) { simulate(folder); });
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("5 frames,"));
    expect_plain_result(folder, settings);
  }
}

// Killed while the simulation writes: once early, and once with a state to go on from.
TEST(Follow, GoesOnAfterKills) {
  const std::vector<std::vector<std::string>> cases{
      {"--set", "output.fields=[phi,stress]"},
      {"--set", "output.fields=[phi,kinetic_stress]", "--set", "average.window=2"}};
  for (const auto& settings : cases) {
    const Folder folder;
    write_pipeline(folder);
    const auto state = folder / "followed/.grainvdb-checkpoint/state";
    const std::vector<std::string> words = follow(settings, {"--last-step", std::to_string(last_step)});
    std::atomic<bool> killed = false;
    std::jthread simulation([&] {
      simulate(folder, 0, 200);
      while (!killed) pause();  // the kill with a state comes before there is all
      simulate(folder, 300);
    });
    const CommandResult early = run_command(words, folder.path(), {}, [](pid_t process) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      kill(process, SIGKILL);
    });
    EXPECT_EQ(early.exit_code, 128 + SIGKILL);
    const CommandResult late = run_command(words, folder.path(), {}, [&](pid_t process) {
      while (!std::filesystem::exists(state)) pause();
      kill(process, SIGKILL);
    });
    killed = true;
    EXPECT_EQ(late.exit_code, 128 + SIGKILL);
    const CommandResult result = run_command(words, folder.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("5 frames,"), HasSubstr("resumed: ")));
    expect_plain_result(folder, settings);
  }
}

TEST(Follow, EndsWhenNothingComesAnyMore) {
  const Folder folder;
  write_pipeline(folder);
  const std::vector<std::string> settings{"--set", "output.fields=[phi]"};
  const CommandResult result =
      run_command(follow(settings, {"--timeout", "2"}), folder.path(), {}, [&](pid_t) { simulate(folder); });
  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_plain_result(folder, settings);
}

TEST(Follow, TakesFramesFromOneFileThatGrows) {
  const Folder folder;
  write_pipeline(folder);
  const std::vector<std::string> settings{"--set", "input.particles=frames/all.txt", "--set", "output.fields=[phi]"};
  const CommandResult result = run_command(follow(settings, {"--last-step", "300"}), folder.path(), {}, [&](pid_t) {
    for (int step = 0; step <= 300; step += 100) write_slowly(folder / "frames/all.txt", dump_text(step));
  });
  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_plain_result(folder, settings);
}

// A simulation that dies leaves half a frame: the run is one on what there is.
TEST(Follow, ReportsWhatIsBadInTheEnd) {
  const Folder folder;
  write_pipeline(folder);
  folder.write("frames/dump0.txt", dump_text(0));
  folder.write("frames/dump100.txt", dump_text(100).substr(0, 900));
  const std::vector<std::string> settings{"--set", "output.fields=[phi]"};
  const CommandResult result = run_command(follow(settings, {"--timeout", "0.3"}), folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("frames/dump100.txt"));
  std::vector<std::string> skipping = settings;
  skipping.insert(skipping.end(), {"--set", "input.on_error=skip_frame"});
  std::filesystem::remove_all(folder / "followed");
  const CommandResult skipped = run_command(follow(skipping, {"--timeout", "0.3"}), folder.path());
  EXPECT_EQ(skipped.exit_code, 0) << skipped.err;
  EXPECT_THAT(skipped.out, AllOf(HasSubstr("1 frame,"), HasSubstr("left out: 1 bad frame")));
}

TEST(Follow, RefusesWhatHasNoEndAndFramesFromTheEnd) {
  const Folder folder;
  write_example(folder);
  const CommandResult endless = run_command({"run", "p.yaml", "--follow"}, folder.path());
  EXPECT_EQ(endless.exit_code, 1);
  EXPECT_THAT(endless.err, HasSubstr("--last-step N, --timeout SECONDS"));
  const CommandResult from_end = run_command(follow({"--frames", "-2:"}, {"--timeout", "1"}), folder.path());
  EXPECT_EQ(from_end.exit_code, 1);
  EXPECT_THAT(from_end.err, HasSubstr("counted from the end"));
  EXPECT_EQ(run_command({"run", "p.yaml", "--last-step", "5"}, folder.path()).exit_code, 1);
}

}  // namespace
}  // namespace grainvdb::test::follow_test
