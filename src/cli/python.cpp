#include "cli/python.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/listed.hpp"
#include "grainvdb/error.hpp"

namespace grainvdb::cli {
namespace {

namespace fs = std::filesystem;

std::vector<char*> argument_list(std::vector<std::string>& words) {
  std::vector<char*> list;
  for (std::string& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  return list;
}

/// Whether an interpreter runs `code` without an error. What it prints is thrown away.
bool succeeds(const std::string& python, const std::string& code) {
  std::vector<std::string> words{python, "-c", code};
  posix_spawn_file_actions_t actions;
  if (posix_spawn_file_actions_init(&actions) != 0) return false;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, python.c_str(), &actions, nullptr, argument_list(words).data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  int status = 0;
  while (waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return false;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string find_python(const std::vector<std::string>& needs) {
  const std::string modules = listed(needs);
  std::vector<std::string> candidates{"python3", "/usr/bin/python3"};
  if (const char* chosen = std::getenv("GRAINVDB_PYTHON"); chosen != nullptr && *chosen != '\0') candidates = {chosen};
  for (const std::string& python : candidates)
    if (succeeds(python, "import " + modules)) return python;
  throw IoError("cannot find a Python with the modules " + modules, candidates.front(), 0,
                "On Debian: apt-get install python3-h5py python3-matplotlib; or name another interpreter in "
                "GRAINVDB_PYTHON");
}

/// Beside the installed command, or in the source tree that it was built from.
std::string package_folder() {
  std::error_code error;
  const fs::path command = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = command.parent_path().parent_path() / GRAINVDB_PYTHON_DIR;
  for (const fs::path& folder : {installed, fs::path(GRAINVDB_SOURCE_PYTHON_DIR)})
    if (fs::is_directory(folder / "grainvdb", error)) return folder.string();
  throw IoError("cannot find the Python part of grainvdb", installed.string(), ENOENT,
                "Install grainvdb again: this folder belongs to it");
}

}  // namespace

void become_python(const std::string& module, const std::vector<std::string>& arguments,
                   const std::vector<std::string>& needs) {
  std::string path = package_folder();
  const std::string python = find_python(needs);
  if (const char* others = std::getenv("PYTHONPATH"); others != nullptr && *others != '\0')
    path += std::string(":") + others;
  setenv("PYTHONPATH", path.c_str(), 1);
  std::vector<std::string> words{python, "-m", module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::cout.flush();
  execvp(python.c_str(), argument_list(words).data());
  throw IoError("cannot run", python, errno);
}

}  // namespace grainvdb::cli
