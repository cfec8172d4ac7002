#include "read/line_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t first_chunk = std::size_t{1} << 14;
constexpr std::size_t largest_chunk = std::size_t{1} << 20;
constexpr std::size_t longest_line = std::size_t{1} << 20;

}  // namespace

LineReader::LineReader(std::unique_ptr<ByteStream> bytes, std::string file)
    : bytes_(std::move(bytes)), file_(std::move(file)), chunk_(first_chunk) {}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const char* start = buffer_.data() + begin_;
    const std::size_t there = end_ - begin_;
    const void* newline = there > searched ? std::memchr(start + searched, '\n', there - searched) : nullptr;
    if (newline != nullptr) {
      line = {start, static_cast<std::size_t>(static_cast<const char*>(newline) - start)};
      last_ = begin_;
      begin_ += line.size() + 1;
      complete_ = true;
      break;
    }
    if (there > longest_line)
      throw InputError({{file_, line_number_ + 1}, "the line is longer than 1 MiB", {}, "a text dump", {}});
    searched = there;
    if (!refill()) {
      if (end_ == begin_) return false;
      line = {buffer_.data() + begin_, end_ - begin_};
      last_ = begin_;
      begin_ = end_;
      complete_ = false;
      break;
    }
  }
  ++line_number_;
  return true;
}

void LineReader::unread() {
  begin_ = last_;
  --line_number_;
}

void LineReader::seek(const TextPosition& position) {
  line_number_ = position.line - 1;
  if (position.offset >= base_ && position.offset <= base_ + end_) {
    begin_ = static_cast<std::size_t>(position.offset - base_);
    return;
  }
  bytes_->seek(position.offset);
  base_ = position.offset;
  begin_ = end_ = 0;
  chunk_ = first_chunk;
  at_end_ = false;
}

/// Moves what is left to the front and reads on; false at the end.
bool LineReader::refill() {
  if (at_end_) return false;
  const std::size_t left = end_ - begin_;
  if (left > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, left);
  base_ += begin_;
  begin_ = 0;
  end_ = left;
  if (buffer_.size() < left + chunk_) buffer_.resize(left + chunk_);
  const std::size_t got = bytes_->read(buffer_.data() + end_, chunk_);
  end_ += got;
  at_end_ = got == 0;
  chunk_ = std::min(2 * chunk_, largest_chunk);
  return !at_end_;
}

}  // namespace grainvdb
