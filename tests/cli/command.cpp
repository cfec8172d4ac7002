#include "cli/command.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace grainvdb::test {
namespace {

// In the child: a descriptor becomes the file.
void redirect(int descriptor, const std::string& path) {
  const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(99);
}

}  // namespace

std::string command_path() {
  return GRAINVDB_COMMAND;
}

CommandResult run_command(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::string& out_path, const std::function<void(pid_t)>& meanwhile) {
  const Folder captured;
  const std::string out = out_path.empty() ? (captured / "out").string() : out_path;
  const std::string err = (captured / "err").string();
  std::vector<std::string> words{command_path()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(98);
    redirect(STDOUT_FILENO, out);
    redirect(STDERR_FILENO, err);
    execv(argv[0], argv.data());
    _exit(97);
  }
  if (meanwhile) meanwhile(child);
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("cannot wait for the command");
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (out_path.empty()) result.out = read_file(out);
  result.err = read_file(err);
  return result;
}

Folder::Folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "grainvdb_cli_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void Folder::write(const std::string& name, const std::string& text) const {
  const std::filesystem::path file = path_ / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::vector<std::string> Folder::names_in(const std::string& folder) const {
  std::vector<std::string> names;
  if (std::filesystem::exists(path_ / folder))
    for (const auto& entry : std::filesystem::directory_iterator(path_ / folder))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Folder::results_in(const std::string& folder) const {
  std::vector<std::string> names = names_in(folder);
  std::erase(names, "run.json");
  return names;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace grainvdb::test
