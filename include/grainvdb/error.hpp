#pragma once
/// The errors that the library throws. Each carries one complete message: where, what was found, what was
/// expected and what to do. The library never prints and never exits; the command turns an error into its exit code.
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace grainvdb {

/// A place in a text file. `line` counts from 1; 0 means the file as a whole.
struct Location {
  Location() = default;
  Location(std::string f, std::size_t l = 0) : file(std::move(f)), line(l) {}

  std::string file;
  std::size_t line = 0;
};

/// "file:line", or "file" when the line is 0.
std::string to_string(const Location& where);

/// What is wrong at a place. Empty parts are left out of the message.
struct Problem {
  Location where;
  std::string what;      ///< the fault in a few words
  std::string found;     ///< the offending text or value
  std::string expected;  ///< what would have been accepted
  std::string hint;      ///< what the user can do about it
};

/// Base of all errors. `exit_code()` is the process exit code that the command documents for this kind.
class Error : public std::runtime_error {
 public:
  Error(const Problem& problem, int exit_code);
  int exit_code() const noexcept { return exit_code_; }
  /// The parts that what() is made of.
  const Problem& problem() const noexcept { return *problem_; }

 private:
  int exit_code_;
  std::shared_ptr<const Problem> problem_;  // shared: errors are copied, which must not throw
};

/// Bad usage, or a pipeline file that cannot be run as written (exit code 1).
class ConfigError : public Error {
 public:
  explicit ConfigError(const Problem& problem) : Error(problem, 1) {}
};

/// A dump that is malformed, or lacks what the pipeline needs (exit code 2).
class InputError : public Error {
 public:
  explicit InputError(const Problem& problem) : Error(problem, 2) {}
};

/// The operating system refused to open, read, write or rename a file (exit code 3).
class IoError : public Error {
 public:
  /// `action` as in "cannot open"; `error_number` is errno at the time, 0 where there is none.
  IoError(const std::string& action, const std::string& path, int error_number, const std::string& hint = {});
};

/// A stated limit was exceeded (extent, memory, …) and the work was refused before it began (exit code 4).
class LimitError : public Error {
 public:
  explicit LimitError(const Problem& problem) : Error(problem, 4) {}
};

}  // namespace grainvdb
