#include "read/text_dump.hpp"

#include <utility>

#include "grainvdb/error.hpp"
#include "read/row_reader.hpp"
#include "read/text.hpp"
#include "read/text_header.hpp"

namespace grainvdb {

bool TextDump::recognise(std::string_view head) {
  return head.starts_with(item_mark);
}

std::unique_ptr<DumpFile> TextDump::open(LineReader lines) {
  return std::make_unique<TextDump>(std::move(lines));
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

bool TextDump::at_end() {
  std::string_view line;
  if (!lines_.next(line)) return true;
  lines_.unread();
  return false;
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
  std::string_view line;
  for (std::size_t row = 0; row < header_.rows; ++row) {
    if (!lines_.next(line)) return false;
    if (line.starts_with(item_mark)) {
      lines_.unread();
      return false;
    }
  }
  check_end_of_rows();
  return true;
}

Table TextDump::read_rows(const TableRequest& request) {
  Table table = RowReader(lines_, header_, label_, request).read();
  check_end_of_rows();
  return table;
}

}  // namespace grainvdb
