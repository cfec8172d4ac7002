#include "read/text_dump.hpp"

#include <algorithm>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/text_header.hpp"

namespace grainvdb {
namespace {

constexpr std::string_view item_mark = "ITEM:";
constexpr const char* cut_off_hint = "The file was cut off, or is still being written: leave this frame out";

std::string_view token_at(const char* p, const char* end) {
  const char* q = p;
  while (q != end && !is_blank(*q)) ++q;
  return {p, static_cast<std::size_t>(q - p)};
}

const char* skip_blanks(const char* p, const char* end) {
  while (p != end && is_blank(*p)) ++p;
  return p;
}

/// Converts the rows of one frame into a table, which grows with the rows that are there: a count in a header is
/// never trusted with memory.
class RowConverter {
 public:
  RowConverter(const LineReader& lines, const FrameHeader& header, const TableRequest& request)
      : lines_(lines), header_(header), request_(request), targets_(header.columns.size()) {
    table_.first_line = lines.line_number() + 1;
    table_.real.resize(request.real.size());
    table_.whole.resize(request.whole.size());
    make_room(std::min(header.rows, std::size_t{1} << 12));
  }

  void add(std::string_view line) {
    if (table_.rows == room_) make_room(room_ > header_.rows / 2 ? header_.rows : 2 * room_);
    const char* const end = line.data() + line.size();
    const char* p = line.data();
    for (std::size_t c = 0; c < targets_.size(); ++c) {
      p = skip_blanks(p, end);
      if (p == end) fail_fields(line);
      p = convert(c, p, end);
    }
    if (skip_blanks(p, end) != end) fail_fields(line);
    ++table_.rows;
  }

  Table finish() {
    make_room(table_.rows);
    return std::move(table_);
  }

 private:
  /// Where the value of a column goes; nowhere when both are null.
  struct Target {
    double* real = nullptr;
    std::int64_t* whole = nullptr;
  };

  const char* convert(std::size_t column, const char* p, const char* end) const {
    const Target& to = targets_[column];
    const char* next = nullptr;
    if (to.real != nullptr) {
      next = parse_real(p, end, to.real[table_.rows]);
      if (next == nullptr) fail_value(column, token_at(p, end), "a finite decimal number", {});
    } else if (to.whole != nullptr) {
      next = parse_whole(p, end, to.whole[table_.rows]);
      if (next == nullptr) {
        const std::string_view token = token_at(p, end);
        const bool has_exponent = token.find_first_of("eE") != std::string_view::npos;
        fail_value(column, token, "a whole number",
                   has_exponent
                       ? "An exponent may hide digits: print the column with 'dump_modify ... format' and %.0f or %d"
                       : "");
      }
    } else {
      next = p + token_at(p, end).size();
    }
    return next;
  }

  void make_room(std::size_t rows) {
    room_ = rows;
    for (std::size_t i = 0; i < request_.real.size(); ++i) {
      table_.real[i].resize(rows);
      targets_[request_.real[i]].real = table_.real[i].data();
    }
    for (std::size_t i = 0; i < request_.whole.size(); ++i) {
      table_.whole[i].resize(rows);
      targets_[request_.whole[i]].whole = table_.whole[i].data();
    }
  }

  [[noreturn]] void fail_value(std::size_t column, std::string_view token, const std::string& expected,
                               const std::string& hint) const {
    throw InputError({{lines_.file(), lines_.line_number()},
                      "bad value in column " + header_.columns[column],
                      in_quotes(token),
                      expected,
                      hint});
  }

  [[noreturn]] void fail_fields(std::string_view line) const {
    std::size_t n = 0;
    for (std::string_view rest = line; !take_token(rest).empty();) ++n;
    throw InputError({{lines_.file(), lines_.line_number()},
                      n < targets_.size() ? "the row is too short" : "the row is too long",
                      std::to_string(n) + " fields in " + in_quotes(line),
                      std::to_string(targets_.size()) + " (" + joined(header_.columns) + ")",
                      {}});
  }

  const LineReader& lines_;
  const FrameHeader& header_;
  const TableRequest& request_;
  std::vector<Target> targets_;
  Table table_;
  std::size_t room_ = 0;
};

}  // namespace

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
  RowConverter rows(lines_, header_, request);
  const auto announced = [&] { return std::to_string(header_.rows) + " " + label_; };
  std::string_view line;
  for (std::size_t row = 0; row < header_.rows; ++row) {
    if (!lines_.next(line))
      fail("the file ends within a frame", std::to_string(row) + " rows", announced(), cut_off_hint);
    if (!lines_.complete())
      fail("the last line does not end in a newline, so the frame is incomplete", in_quotes(line), announced(),
           cut_off_hint);
    if (line.starts_with(item_mark))
      fail("the next frame begins too early", in_quotes(line) + " after " + std::to_string(row) + " rows", announced());
    rows.add(line);
  }
  check_end_of_rows();
  return rows.finish();
}

}  // namespace grainvdb
