#include "read/text_dump.hpp"

#include <algorithm>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/row_kernel.hpp"
#include "read/row_reader.hpp"
#include "read/text.hpp"
#include "read/text_header.hpp"

namespace grainvdb {
namespace {
constexpr std::size_t longest_piece = std::size_t{1} << 14;
}

bool TextDump::recognise(std::string_view head) {
  return head.starts_with(item_mark);
}

std::unique_ptr<DumpFile> TextDump::open(std::unique_ptr<ByteStream> bytes, const std::string& file) {
  return std::make_unique<TextDump>(LineReader(std::move(bytes), file));
}

void TextDump::fail(const std::string& what, const std::string& found, const std::string& expected,
                    const std::string& hint) const {
  throw InputError({{lines_.file(), lines_.line_number()}, what, found, expected, hint});
}

std::optional<FrameHeader> TextDump::next_header() {
  TextHeaderReader reader(lines_);
  std::optional<FrameHeader> header = reader.read();
  if (header) {
    header_ = *header;
    label_ = reader.label();
  }
  return header;
}

/// After the last row comes the end of the file or the next frame.
void TextDump::check_end_of_rows() {
  std::string_view line;
  if (!lines_.next(line)) return;
  if (!line.starts_with(item_mark))
    fail("there is text after the last row of the frame", in_quotes(line),
         "the end of the file or 'ITEM:' after " + std::to_string(header_.rows) + " " + label_);
  lines_.unread();
}

bool TextDump::skip_rows() {
  std::size_t left = header_.rows;
  while (left > 0) {
    // Small pieces, as the one in which the frame ends is counted in vain.
    std::string_view piece = lines_.lines();
    if (piece.size() > longest_piece) piece = piece.substr(0, piece.rfind('\n', longest_piece) + 1);
    const LineCount count = count_lines(piece.data(), piece.size());
    if (count.lines > 0 && count.lines <= left && count.marked == 0) {
      lines_.pass(piece.size(), count.lines);
      left -= count.lines;
    } else if (!skip_one_by_one(std::clamp<std::size_t>(count.lines, 1, left), left)) {
      return false;
    }
  }
  check_end_of_rows();
  return true;
}

/// Passes over `count` rows, and takes them off `left`; false when the file or the next frame comes before.
bool TextDump::skip_one_by_one(std::size_t count, std::size_t& left) {
  std::string_view line;
  for (; count > 0; --count, --left) {
    if (!lines_.next(line) || !lines_.complete()) return false;
    if (line.starts_with(item_mark)) {
      lines_.unread();
      return false;
    }
  }
  return true;
}

DumpTable TextDump::read_rows(const TableRequest& request) {
  DumpTable table = RowReader(lines_, header_, label_, request).read();
  check_end_of_rows();
  return table;
}

}  // namespace grainvdb
