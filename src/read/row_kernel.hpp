#pragma once
/// Numbers in rows of text, many at a time: the vector loops behind RowConverter.
///
/// They take what a dump prints nearly always, tokens of at most 14 characters behind the sign such as 12, -0.00370913
/// or 6.7897e-07, and leave every other token to parse_real and parse_whole, with which they agree to the bit. 64 bytes
/// (text_margin) must be readable before and behind the text.
#include <array>
#include <cstddef>
#include <cstdint>

namespace grainvdb {

/// Where the tokens and the lines of a piece of text are.
struct LineIndex {
  static constexpr std::size_t window = std::size_t{1} << 13;  ///< most bytes of text

  std::size_t tokens = 0;  ///< those cut off at the end of the text included
  std::size_t lines = 0;   ///< those that end in a newline
  /// False when the text has control characters other than blanks and newlines: nothing below may be used then.
  bool plain = true;
  std::array<std::uint32_t, window / 2 + 65> starts;  ///< of the tokens, in bytes from the start of the text
  std::array<std::uint32_t, window + 2> newlines;     ///< at which the lines end
};

/// Finds tokens and lines in `size` bytes (at most LineIndex::window) that begin at the start of a line.
void index_lines(const char* text, std::size_t size, LineIndex& index);

struct LineCount {
  std::size_t lines = 0;
  std::size_t marked = 0;  ///< those that begin with an I, as "ITEM:" does
};

/// Counts the lines of a text that begins at the start of a line and ends with a newline.
LineCount count_lines(const char* text, std::size_t size);

/// Converts one column: values[i] of the token at text + starts[i * stride], for i < rows. Puts the rows whose tokens
/// it leaves to others into `left`, in ascending order, and returns their number. The text must be plain (see
/// LineIndex).
///
/// A token of n digits, m of them behind the point, and the exponent x is M 10^(x-m) with a whole number M below 10^15.
/// M and 10^|x-m| up to 10^22 are doubles without rounding, so that one product or quotient of the two is rounded
/// correctly (W. D. Clinger, How to read floating point numbers accurately, 1990).
std::size_t convert_reals(const char* text, const std::uint32_t* starts, std::size_t stride, std::size_t rows,
                          double* values, std::uint32_t* left);
/// The same for whole numbers; leaves those written with a point.
std::size_t convert_wholes(const char* text, const std::uint32_t* starts, std::size_t stride, std::size_t rows,
                           std::int64_t* values, std::uint32_t* left);

}  // namespace grainvdb
