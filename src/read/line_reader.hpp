#pragma once
/// The lines of a byte stream, without a copy per line.
#include <cstddef>
#include <cstdint>
#include <exception>
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
  std::size_t frame = 0;  ///< frames of the file before it, in formats whose frames are known by that alone
};

/// Longer lines are refused: they do not stand in dumps.
constexpr std::size_t longest_line = std::size_t{1} << 20;

/// How many readable bytes lie before and behind what LineReader::lines gives, so that vectors may be loaded there.
constexpr std::size_t text_margin = 64;

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
  /// Whether no line is left. Throws like next().
  bool at_end();

  /// Whole lines from the next one on, with their newlines: those that are at hand, one at least. Empty when none is
  /// left that ends in a newline. Valid until next() or lines() is called again. Throws like next().
  std::string_view lines();
  /// Passes over the first `count` of those lines, which have that many bytes.
  void pass(std::size_t bytes, std::size_t count);
  /// After lines(): reads about that many bytes more, while others use the lines. What fails is thrown by next() or
  /// lines() where it would have been thrown without reading ahead.
  void read_ahead(std::size_t bytes);

  /// The number of the last line given.
  std::size_t line_number() const { return line_number_; }
  const std::string& file() const { return file_; }

  /// Where the next line begins.
  TextPosition position() const { return {base_ + begin_ - text_margin, line_number_ + 1}; }
  /// Continues at a position that position() gave before.
  void seek(const TextPosition& position);

 private:
  /// Bytes of the stream, with a margin before and behind.
  struct Buffer {
    std::vector<char> bytes;
    std::size_t end = text_margin;  ///< of what the stream gave
  };

  bool find_newline(std::size_t& at);
  bool refill();
  void read_chunk(Buffer& to);

  std::unique_ptr<ByteStream> bytes_;
  std::string file_;
  Buffer buffer_;
  Buffer ahead_;  ///< begins with what follows the last newline of buffer_
  bool have_ahead_ = false;
  std::exception_ptr failure_;           ///< of the stream, behind what is in the buffers
  std::size_t chunk_;                    ///< how much to ask for next; grows, so that a header costs little
  std::uint64_t base_ = 0;               ///< where the buffer begins in the stream
  std::size_t begin_ = text_margin;      ///< of the next line, in the buffer
  std::size_t last_ = 0;                 ///< where the last line began
  std::size_t lines_end_ = text_margin;  ///< where the lines end that lines() gave
  std::size_t line_number_ = 0;
  bool complete_ = true;
  bool at_end_ = false;
};

}  // namespace grainvdb
