#include "read/file_list.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <system_error>

#include <glob.h>
#include <sys/stat.h>

namespace grainvdb {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::size_t digit_run(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && is_digit(text[n])) ++n;
  return n;
}

std::string_view without_zeros(std::string_view digits) {
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

struct stat examine(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw IoError("cannot open", path, errno);
  return status;
}

/// What a glob matches, the pattern itself when a file has that very name.
std::vector<std::string> expand(const std::string& pattern) {
  struct stat status {};
  if (pattern.find_first_of("*?[") == std::string::npos || ::stat(pattern.c_str(), &status) == 0) return {pattern};
  glob_t found{};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT | GLOB_ERR, nullptr, &found);
  const int error = errno;
  std::vector<std::string> paths(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (code == GLOB_ABORTED) throw IoError("cannot list the directories of the pattern", pattern, error);
  if (code == GLOB_NOSPACE) throw std::bad_alloc();
  return paths;
}

class FileList {
 public:
  explicit FileList(Location where) : where_(std::move(where)) {}

  void add(const std::string& path) {
    const struct stat status = examine(path);
    if (S_ISREG(status.st_mode)) {
      put(path, status, true);
    } else if (S_ISDIR(status.st_mode)) {
      add_directory(path);
    } else {
      throw InputError({where_, "'" + path + "' is neither a regular file nor a directory", {}, {}, {}});
    }
  }

  std::vector<InputFile> sorted() const {
    std::vector<InputFile> files;
    for (const auto& [identity, file] : files_) files.push_back(file);
    std::sort(files.begin(), files.end(),
              [](const InputFile& a, const InputFile& b) { return natural_less(a.path, b.path); });
    return files;
  }

 private:
  void add_directory(const std::string& directory) {
    std::error_code error;
    std::filesystem::directory_iterator it(directory, error);
    for (; !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
      if (it->path().filename().string().front() == '.') continue;
      struct stat status {};
      // A dangling link is no file of the directory.
      if (::stat(it->path().c_str(), &status) == 0 && S_ISREG(status.st_mode)) put(it->path().string(), status, false);
    }
    if (error) throw IoError("cannot list the directory", directory, error.value());
  }

  /// Of several names of one file the first in natural order counts, so that the result has one name for any order of
  /// patterns.
  void put(const std::string& path, const struct stat& status, bool named) {
    const FileIdentity identity{status.st_dev, status.st_ino};
    const std::int64_t changed = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
    const InputFile file{path, static_cast<std::uintmax_t>(status.st_size), changed, identity, named};
    const auto [entry, is_new] = files_.emplace(identity, file);
    if (is_new) return;
    entry->second.named |= named;
    if (natural_less(path, entry->second.path)) entry->second.path = path;
  }

  Location where_;
  std::map<FileIdentity, InputFile> files_;
};

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::string_view p = a, q = b;
  while (!p.empty() && !q.empty()) {
    if (is_digit(p.front()) && is_digit(q.front())) {
      const std::size_t n = digit_run(p), m = digit_run(q);
      const std::string_view u = without_zeros(p.substr(0, n)), v = without_zeros(q.substr(0, m));
      if (u.size() != v.size()) return u.size() < v.size();
      if (u != v) return u < v;
      p.remove_prefix(n);
      q.remove_prefix(m);
    } else {
      if (p.front() != q.front()) return static_cast<unsigned char>(p.front()) < static_cast<unsigned char>(q.front());
      p.remove_prefix(1);
      q.remove_prefix(1);
    }
  }
  if (p.empty() != q.empty()) return p.empty();
  return a < b;
}

std::vector<InputFile> list_files(const std::vector<std::string>& patterns, const Location& where) {
  FileList list(where);
  for (const std::string& pattern : patterns) {
    const std::vector<std::string> paths = pattern.empty() ? std::vector<std::string>{} : expand(pattern);
    if (paths.empty())
      throw InputError(
          {where, "no file matches '" + pattern + "'", {}, "a path, a directory or a glob with * ? []", {}});
    for (const std::string& path : paths) list.add(path);
  }
  return list.sorted();
}

}  // namespace grainvdb
