#pragma once
/// The rows of one frame of a text dump, converted piece by piece, by several threads where there are many.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "read/dump_file.hpp"
#include "read/line_reader.hpp"
#include "read/row_converter.hpp"

namespace grainvdb {

class RowReader {
 public:
  /// `lines` stands behind the header. `label` is what the frame calls its rows. All must outlive the reader.
  RowReader(LineReader& lines, const FrameHeader& header, const std::string& label, const TableRequest& request);

  /// Converts the requested columns of all rows. Neither the table nor an error depends on the number of threads: an
  /// error is that of the first line that is wrong. Memory grows with the rows that are there: the count in the header
  /// is never trusted with it. Throws InputError.
  DumpTable read();

 private:
  std::size_t bytes_left() const;
  void convert(std::string_view text);
  void take(std::string_view text, const std::vector<std::string_view>& unconverted);
  void append(std::size_t rows, std::size_t blocks);
  std::string announced() const;
  [[noreturn]] void fail(const std::string& what, const std::string& found, const std::string& hint) const;
  [[noreturn]] void refuse_end();
  [[noreturn]] void refuse_line();

  LineReader& lines_;
  const FrameHeader& header_;
  const std::string& label_;
  RowConverter converter_;
  std::vector<RowBlock> blocks_;
  DumpTable table_;
  std::size_t room_ = 0;   ///< rows that the columns have memory for
  std::size_t bytes_ = 0;  ///< of the rows in the table
};

}  // namespace grainvdb
