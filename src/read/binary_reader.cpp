#include "read/binary_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {
constexpr std::size_t buffer_size = std::size_t{1} << 16;
}

BinaryReader::BinaryReader(std::unique_ptr<ByteStream> bytes, std::string file)
    : bytes_(std::move(bytes)), file_(std::move(file)), buffer_(buffer_size) {}

void BinaryReader::fail(const std::string& what, const std::string& found, const std::string& expected,
                        const std::string& hint) const {
  throw InputError({{file_, 0}, what + " at byte " + std::to_string(position()), found, expected, hint});
}

/// Once the buffer is used up; false at the end.
bool BinaryReader::refill() {
  base_ += end_;
  begin_ = 0;
  end_ = bytes_->read(buffer_.data(), buffer_.size());
  return end_ > 0;
}

void BinaryReader::read(void* out, std::size_t n) {
  char* to = static_cast<char*>(out);
  while (n > 0) {
    if (begin_ == end_ && !refill())
      fail("the file ends within a frame,", std::to_string(n) + " bytes less than needed", {},
           "The file was cut off, or is still being written: leave this frame out");
    const std::size_t taken = std::min(n, end_ - begin_);
    std::memcpy(to, buffer_.data() + begin_, taken);
    begin_ += taken;
    to += taken;
    n -= taken;
  }
}

std::string BinaryReader::text(std::size_t n) {
  std::string text;
  while (text.size() < n) {
    const std::size_t have = text.size(), more = std::min(n - have, buffer_size);
    text.resize(have + more);
    read(text.data() + have, more);
  }
  return text;
}

bool BinaryReader::skip(std::uint64_t n) {
  if (n <= end_ - begin_) {
    begin_ += static_cast<std::size_t>(n);
    return true;
  }
  // A plain file can be sought behind its end: the last byte shows whether it is there.
  const std::uint64_t last = position() + n - 1;
  if (last < position()) return false;
  try {
    seek(last);
  } catch (const InputError&) {
    return false;  // a compressed file that ends before
  } catch (const IoError&) {
    return false;  // farther than any file reaches
  }
  if (at_end()) return false;
  ++begin_;
  return true;
}

bool BinaryReader::at_end() {
  return begin_ == end_ && !refill();
}

void BinaryReader::seek(std::uint64_t offset) {
  bytes_->seek(offset);
  base_ = offset;
  begin_ = end_ = 0;
}

}  // namespace grainvdb
