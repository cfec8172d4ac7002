#pragma once
/// Runs the built command and captures what it prints.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace grainvdb::test {

struct CommandResult {
  int exit_code = -1;  ///< 128 + the signal's number when one ended it
  std::string out;
  std::string err;
};

/// The command as it was built.
std::string command_path();

/// Runs `grainvdb arguments…` in a folder. `meanwhile` is called with the process while it runs. Its standard output
/// goes to `out_path` where that is given.
CommandResult run_command(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::string& out_path = {}, const std::function<void(pid_t)>& meanwhile = {});

/// A new folder that is removed, with all that is in it, when the object goes.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  void write(const std::string& name, const std::string& text) const;
  std::vector<std::string> names_in(const std::string& folder) const;
  /// Those of the results, which are the same for the same pipeline and dumps; `run.json` is what it took to make them.
  std::vector<std::string> results_in(const std::string& folder) const;

 private:
  std::filesystem::path path_;
};

std::string read_file(const std::filesystem::path& path);

}  // namespace grainvdb::test
