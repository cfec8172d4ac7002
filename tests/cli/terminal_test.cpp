/// The line of progress at a terminal, and Ctrl-C.
#include <chrono>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test::terminal_test {
namespace {

using ::testing::HasSubstr;

// What the command prints at a terminal of its own; nothing where the system has no terminals to give.
std::optional<std::string> printed_at_terminal(const std::vector<std::string>& arguments,
                                               const std::filesystem::path& folder) {
  std::vector<std::string> words{command_path()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child < 0) return std::nullopt;
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(98);
    execv(argv[0], argv.data());
    _exit(97);
  }
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text;
  return text;
}

TEST(Terminal, ShowsProgressWithTheTimeLeft) {
  const Folder folder;
  write_example(folder);
  const auto text = printed_at_terminal({"run", "p.yaml"}, folder.path());
  if (!text) GTEST_SKIP() << "this system has no pseudo-terminals";
  EXPECT_THAT(*text, ::testing::AllOf(HasSubstr("\r\x1b[Kframes: 1/3 (33 %), "), HasSubstr(" s left")));
  EXPECT_EQ(printed_at_terminal({"run", "p.yaml", "-q"}, folder.path()), "");
}

TEST(Interrupt, LeavesNoOutput) {
  const Folder folder;
  // Enough frames to last for seconds, far longer than a signal takes.
  std::string dump;
  for (int k = 0; k < 20'000; ++k) {
    dump +=
        "ITEM: TIMESTEP\n" + std::to_string(k) +
        "\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 4\nITEM: ATOMS id x y z radius\n1 2 2 2 "
        "0.5\n";
  }
  folder.write("frames/dump0.txt", dump);
  folder.write("p.yaml", pipeline_text());
  for (int signal_number : {SIGINT, SIGTERM}) {
    // The signal comes when the first files, still temporary, are there.
    bool began = false;
    const auto interrupt = [&](pid_t process) {
      for (int wait = 0; wait < 60'000 && !began; ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        began = !folder.names_in("output").empty();
      }
      kill(process, signal_number);
    };
    const CommandResult result = run_command({"run", "p.yaml", "--set", "output.fields=[phi]", "--set",
                                              "average.window=1", "--set", "output.formats=[hdf5,vdb]"},
                                             folder.path(), {}, interrupt);
    EXPECT_TRUE(began);
    EXPECT_EQ(result.exit_code, 128 + signal_number);
    EXPECT_EQ(result.err, "grainvdb: interrupted; nothing was written\n");
    EXPECT_THAT(folder.names_in("output"), ::testing::IsEmpty());
  }
}

}  // namespace
}  // namespace grainvdb::test::terminal_test
