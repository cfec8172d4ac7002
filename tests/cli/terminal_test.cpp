/// What only happens at a terminal: the line of progress, and Ctrl-C.
#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/command.hpp"
#include "cli/example_dumps.hpp"

namespace grainvdb::test {
namespace {

using testing::HasSubstr;

struct TerminalResult {
  int exit_code = -1;
  std::string text;
};

// Runs the command at a terminal of its own; sends it a signal, if any, as soon as it has printed `awaited`.
TerminalResult run_at_terminal(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                               const std::string& awaited = {}, int signal_number = 0) {
  std::vector<std::string> words{GRAINVDB_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child < 0) throw std::runtime_error("cannot make a terminal");
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(98);
    execv(argv[0], argv.data());
    _exit(97);
  }
  TerminalResult result;
  char buffer[4096];
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) {
    result.text.append(buffer, static_cast<std::size_t>(n));
    if (signal_number != 0 && result.text.find(awaited) != std::string::npos) {
      kill(child, signal_number);
      signal_number = 0;
    }
  }
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

TEST(Terminal, ShowsProgressWithTheTimeLeft) {
  const Folder folder;
  write_example(folder);
  const TerminalResult result = run_at_terminal({"run", "p.yaml"}, folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.text;
  EXPECT_THAT(result.text, testing::AllOf(HasSubstr("\r\x1b[Kframes: 1/3 (33 %), "), HasSubstr(" s left")));
  const TerminalResult quiet = run_at_terminal({"run", "p.yaml", "-q"}, folder.path());
  EXPECT_EQ(quiet.text, "");
}

TEST(Terminal, AnInterruptLeavesNoOutput) {
  const Folder folder;
  // Enough frames to last for seconds, far longer than a signal takes.
  std::string dump;
  for (int k = 0; k < 20'000; ++k) {
    dump += "ITEM: TIMESTEP\n" + std::to_string(k) +
            "\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 4\nITEM: ATOMS id x y z radius\n1 2 2 "
            "2 0.5\n";
  }
  folder.write("frames/dump0.txt", dump);
  folder.write("p.yaml", pipeline_text());
  for (int signal_number : {SIGINT, SIGTERM}) {
    const TerminalResult result = run_at_terminal({"run", "p.yaml", "--set", "output.fields=[phi]", "--set",
                                                   "average.window=1", "--set", "output.formats=[hdf5,vdb]"},
                                                  folder.path(), "frames: ", signal_number);
    EXPECT_EQ(result.exit_code, 128 + signal_number) << result.text.substr(0, 500);
    EXPECT_THAT(result.text, HasSubstr("grainvdb: interrupted; nothing was written"));
    EXPECT_THAT(folder.names_in("output"), testing::IsEmpty());
  }
}

}  // namespace
}  // namespace grainvdb::test
