#include "read/line_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t first_chunk = std::size_t{1} << 14;
/// Fits into the second-level cache together with the numbers made of it.
constexpr std::size_t largest_chunk = std::size_t{1} << 18;

}  // namespace

LineReader::LineReader(std::unique_ptr<ByteStream> bytes, std::string file)
    : bytes_(std::move(bytes)), file_(std::move(file)), chunk_(first_chunk) {}

/// Finds the newline of the line that begins here; false, and the end of the stream, when there is none.
bool LineReader::find_newline(std::size_t& at) {
  std::size_t searched = 0;
  for (;;) {
    const char* start = buffer_.bytes.data() + begin_;
    const std::size_t there = buffer_.end - begin_;
    const void* newline = there > searched ? std::memchr(start + searched, '\n', there - searched) : nullptr;
    const std::size_t length =
        newline != nullptr ? static_cast<std::size_t>(static_cast<const char*>(newline) - start) : there;
    if (length > longest_line)
      throw InputError({{file_, line_number_ + 1}, "the line is longer than 1 MiB", {}, "a text dump", {}});
    if (newline != nullptr) {
      at = begin_ + length;
      return true;
    }
    searched = there;
    if (!refill()) {
      at = buffer_.end;
      return false;
    }
  }
}

bool LineReader::next(std::string_view& line) {
  std::size_t newline = 0;
  complete_ = find_newline(newline);
  if (!complete_ && buffer_.end == begin_) return false;
  line = {buffer_.bytes.data() + begin_, newline - begin_};
  last_ = begin_;
  begin_ = newline + (complete_ ? 1 : 0);
  ++line_number_;
  return true;
}

bool LineReader::at_end() {
  std::string_view line;
  if (!next(line)) return true;
  unread();
  return false;
}

void LineReader::unread() {
  begin_ = last_;
  --line_number_;
}

std::string_view LineReader::lines() {
  std::size_t newline = 0;
  if (!find_newline(newline)) return {};
  const char* const start = buffer_.bytes.data() + begin_;
  const void* last = ::memrchr(start, '\n', buffer_.end - begin_);
  const auto size = static_cast<std::size_t>(static_cast<const char*>(last) - start) + 1;
  lines_end_ = begin_ + size;
  return {start, size};
}

void LineReader::pass(std::size_t bytes, std::size_t count) {
  begin_ += bytes;
  line_number_ += count;
}

void LineReader::seek(const TextPosition& position) {
  line_number_ = position.line - 1;
  if (position.offset >= base_ && position.offset <= base_ + (buffer_.end - text_margin)) {
    begin_ = static_cast<std::size_t>(position.offset - base_) + text_margin;
    return;
  }
  bytes_->seek(position.offset);
  base_ = position.offset;
  begin_ = buffer_.end = text_margin;
  have_ahead_ = false;
  failure_ = nullptr;
  chunk_ = first_chunk;
  at_end_ = false;
}

/// Adds a chunk to a buffer. Chunks do not depend on who reads them, so that a failure of the stream always comes
/// behind the same bytes.
void LineReader::read_chunk(Buffer& to) {
  const std::size_t size = to.end + chunk_ + text_margin;
  if (to.bytes.size() < size) to.bytes.resize(size);
  const std::size_t got = bytes_->read(to.bytes.data() + to.end, chunk_);
  to.end += got;
  at_end_ = got == 0;
  chunk_ = std::min(2 * chunk_, largest_chunk);
}

void LineReader::read_ahead(std::size_t bytes) {
  if (have_ahead_ || at_end_ || failure_) return;
  const std::size_t left = buffer_.end - lines_end_;
  const std::size_t size = text_margin + left + bytes + largest_chunk + text_margin;
  if (ahead_.bytes.size() < size) ahead_.bytes.resize(size);
  std::memcpy(ahead_.bytes.data() + text_margin, buffer_.bytes.data() + lines_end_, left);
  ahead_.end = text_margin + left;
  have_ahead_ = true;
  try {
    while (!at_end_ && ahead_.end < text_margin + left + bytes) read_chunk(ahead_);
  } catch (...) {
    failure_ = std::current_exception();
  }
}

/// Moves what is left to the front and reads on; false at the end.
bool LineReader::refill() {
  const std::size_t left = buffer_.end - begin_;
  base_ += begin_ - text_margin;
  begin_ = text_margin;
  if (have_ahead_) {
    std::swap(buffer_, ahead_);
    have_ahead_ = false;
    if (buffer_.end > text_margin + left) return true;
  } else if (left > 0) {
    std::memmove(buffer_.bytes.data() + text_margin, buffer_.bytes.data() + (buffer_.end - left), left);
  }
  buffer_.end = text_margin + left;
  if (failure_) std::rethrow_exception(failure_);
  if (at_end_) return false;
  read_chunk(buffer_);
  return !at_end_;
}

}  // namespace grainvdb
