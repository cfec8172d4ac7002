#include "write/checked_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 20;

std::uint32_t add_to_checksum(std::uint32_t checksum, const char* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(crc32_z(checksum, reinterpret_cast<const Bytef*>(bytes), count));
}

}  // namespace

CheckedFileWriter::CheckedFileWriter(const std::string& path)
    : file_(path), checksum_(static_cast<std::uint32_t>(crc32_z(0, nullptr, 0))) {
  buffer_.reserve(buffer_size);
}

void CheckedFileWriter::write(const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const std::size_t n = std::min(count, buffer_size - buffer_.size());
    buffer_.insert(buffer_.end(), from, from + n);
    from += n;
    count -= n;
    if (buffer_.size() == buffer_size) flush();
  }
}

void CheckedFileWriter::flush() {
  checksum_ = add_to_checksum(checksum_, buffer_.data(), buffer_.size());
  file_.write(offset_, std::as_bytes(std::span(buffer_)));
  offset_ += buffer_.size();
  buffer_.clear();
}

void CheckedFileWriter::publish() {
  flush();
  file_.write(offset_, std::as_bytes(std::span(&checksum_, 1)));
  file_.finish();
  file_.publish();
}

CheckedFileReader::CheckedFileReader(const std::string& path)
    : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw IoError("cannot open", path, errno);
  try {
    check();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

CheckedFileReader::~CheckedFileReader() {
  ::close(descriptor_);
}

void CheckedFileReader::refuse() const {
  throw InputError({{path_, 0}, "the file is damaged", {}, {}, "Remove its folder; the run then begins anew"});
}

void CheckedFileReader::check() {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) throw IoError("cannot get the size", path_, errno);
  std::uint32_t written = 0;
  if (status.st_size < static_cast<off_t>(sizeof written)) refuse();
  const auto size = static_cast<std::uint64_t>(status.st_size) - sizeof written;
  auto checksum = static_cast<std::uint32_t>(crc32_z(0, nullptr, 0));
  for (left_ = size; left_ > 0;) {
    fill();
    checksum = add_to_checksum(checksum, buffer_.data(), buffer_.size());
  }
  if (::pread(descriptor_, &written, sizeof written, static_cast<off_t>(size)) != sizeof written) refuse();
  if (written != checksum) refuse();
  if (::lseek(descriptor_, 0, SEEK_SET) != 0) throw IoError("cannot seek", path_, errno);
  left_ = size;
  buffer_.clear();
}

void CheckedFileReader::fill() {
  buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left_, buffer_size)));
  begin_ = 0;
  std::size_t got = 0;
  while (got < buffer_.size()) {
    const ssize_t n = ::read(descriptor_, buffer_.data() + got, buffer_.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError("cannot read", path_, errno);
    if (n == 0) refuse();
    got += static_cast<std::size_t>(n);
  }
  left_ -= got;
}

void CheckedFileReader::read(void* bytes, std::size_t count) {
  char* to = static_cast<char*>(bytes);
  while (count > 0) {
    if (begin_ == buffer_.size()) {
      if (left_ == 0) refuse();
      fill();
    }
    const std::size_t n = std::min(count, buffer_.size() - begin_);
    std::memcpy(to, buffer_.data() + begin_, n);
    to += n;
    begin_ += n;
    count -= n;
  }
}

}  // namespace grainvdb
