#pragma once
/// The lines of a byte stream, without a copy per line.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "read/byte_stream.hpp"

namespace grainvdb {

/// A place between lines: the byte at which a line begins, and the number of that line, counted from 1.
struct TextPosition {
  std::uint64_t offset = 0;
  std::size_t line = 1;
};

class LineReader {
 public:
  LineReader(std::unique_ptr<ByteStream> bytes, std::string file);

  /// The next line without its newline, valid until the next call; false at the end. Throws InputError for a line
  /// longer than 1 MiB, and whatever the stream throws.
  bool next(std::string_view& line);
  /// Whether the last line ended in a newline. A last line that does not was cut off, even if it parses.
  bool complete() const { return complete_; }
  /// Takes back the last line: next() gives it again. May be called once after each next() that gave a line.
  void unread();

  /// The number of the last line given.
  std::size_t line_number() const { return line_number_; }
  const std::string& file() const { return file_; }

  /// Where the next line begins.
  TextPosition position() const { return {base_ + begin_, line_number_ + 1}; }
  /// Continues at a position that position() gave before.
  void seek(const TextPosition& position);

 private:
  bool refill();

  std::unique_ptr<ByteStream> bytes_;
  std::string file_;
  std::vector<char> buffer_;
  std::size_t chunk_;       ///< how much to ask for next; grows, so that a header costs little and a file goes fast
  std::uint64_t base_ = 0;  ///< offset of buffer_[0] in the stream
  std::size_t begin_ = 0;   ///< of the next line, in the buffer
  std::size_t end_ = 0;     ///< of the bytes in the buffer
  std::size_t last_ = 0;    ///< where the last line began
  std::size_t line_number_ = 0;
  bool complete_ = true;
  bool at_end_ = false;
};

}  // namespace grainvdb
