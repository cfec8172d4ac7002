#include "grainvdb/error.hpp"

#include <cstring>

namespace grainvdb {

std::string to_string(const Location& where) {
  return where.line == 0 ? where.file : where.file + ":" + std::to_string(where.line);
}

namespace {

std::string message(const Problem& p) {
  std::string text = to_string(p.where);
  if (!text.empty()) text += ": ";
  text += p.what;
  if (!p.found.empty()) text += "; found " + p.found;
  if (!p.expected.empty()) text += "; expected " + p.expected;
  if (!p.hint.empty()) text += ". " + p.hint;
  return text;
}

}  // namespace

Error::Error(const Problem& problem, int exit_code)
    : std::runtime_error(message(problem)), exit_code_(exit_code), problem_(std::make_shared<Problem>(problem)) {}

IoError::IoError(const std::string& action, const std::string& path, int error_number, const std::string& hint)
    : Error({Location{path},
             error_number == 0 ? action : action + " (" + std::strerror(error_number) + ")",
             {},
             {},
             hint},
            3) {}

}  // namespace grainvdb
