#include "write/atomic_file.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// Makes a rename durable. The file is complete under its name already, so a folder that cannot be synced is no
/// failure.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// NAME.<process>-<number>.tmp
bool is_temporary(const std::string& name) {
  static const std::regex pattern(".+\\.[0-9]+-[0-9]+\\.tmp");
  return std::regex_match(name, pattern);
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  const fs::path folder = folder_of(path_);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError("cannot create the folder", folder.string(), error.value());
  if (fs::is_directory(path_, error)) fail("cannot write a file here", EISDIR);

  static std::atomic<unsigned> next{0};
  do {
    temporary_path_ = path_ + '.' + std::to_string(::getpid()) + '-' + std::to_string(next++) + ".tmp";
    descriptor_ = ::open(temporary_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) fail("cannot create a file in this folder", errno);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!published_) ::unlink(temporary_path_.c_str());
}

void AtomicFile::fail(const char* action, int error_number) const {
  throw IoError(action, path_, error_number);
}

void AtomicFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("cannot write", n < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

void AtomicFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot read back", errno);
    if (n == 0) {
      std::fill(bytes.begin(), bytes.end(), std::byte{0});
      return;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

std::uint64_t AtomicFile::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("cannot get the size", errno);
  return static_cast<std::uint64_t>(status.st_size);
}

void AtomicFile::resize(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("cannot set the size", errno);
}

void AtomicFile::finish() {
  if (::fsync(descriptor_) != 0) fail("cannot write to the disk", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot close", errno);
}

void AtomicFile::publish() {
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) fail("cannot rename the finished file", errno);
  published_ = true;
  sync_folder(folder_of(path_));
}

void remove_leftovers(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (is_temporary(entry.path().filename().string())) leftovers.push_back(entry.path().string());
  if (error) throw IoError("cannot list the folder", folder, error.value());
  for (const std::string& file : leftovers) remove_file(file);
}

void remove_file(const std::string& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) throw IoError("cannot remove an outdated file", path, errno);
}

}  // namespace grainvdb
