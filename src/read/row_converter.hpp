#pragma once
/// From the text of rows to numbers.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "grainvdb/error.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

struct LineIndex;

/// Rows converted from one piece of text: `rows` values in each requested column. The vectors may be longer, so that
/// a block that is used again costs no memory.
struct RowBlock {
  std::size_t rows = 0;
  std::vector<std::vector<double>> real;
  std::vector<std::vector<std::int64_t>> whole;

  void make_room(std::size_t n);
};

/// Converts the requested columns of rows. It may be used from several threads at once, for different blocks.
class RowConverter {
 public:
  /// Both must outlive the converter.
  RowConverter(const FrameHeader& header, const TableRequest& request);

  /// Converts whole lines from the front of `lines` into the block, which has then at most `most_rows` rows, and takes
  /// them off `lines`. Stops at a line that is not a row. There must be text_margin readable bytes before and behind.
  void convert(std::string_view& lines, std::size_t most_rows, RowBlock& block) const;

  /// Throws the InputError that says why a line is not a row.
  [[noreturn]] void refuse(std::string_view line, const Location& where) const;

 private:
  std::size_t rows_in(const char* text, const LineIndex& index) const;
  std::size_t convert_columns(const char* text, const LineIndex& index, std::size_t rows, RowBlock& block) const;
  bool convert_line(std::string_view line, RowBlock& block) const;

  const FrameHeader& header_;
  const TableRequest& request_;
  std::size_t fields_;
  std::vector<std::size_t>
      by_column_;  ///< for each column the index in `real`, or that in `whole` behind all of `real`
};

}  // namespace grainvdb
