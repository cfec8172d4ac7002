#include "read/row_reader.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "grainvdb/error.hpp"
#include "read/huge_pages.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr const char* cut_off_frame_hint = "The file was cut off, or is still being written: leave this frame out";

/// What one thread converts at a time. Text and numbers fit into the second-level cache together.
constexpr std::size_t piece_size = std::size_t{1} << 17;
/// What is in memory as text at once, for each thread and at most.
constexpr std::size_t batch_per_thread = std::size_t{1} << 20, largest_batch = std::size_t{1} << 24;
/// For how many times the rows that were met there may be room in a table. Address space only: memory is taken when it
/// is written. A first piece of 16 kB then makes room for a million rows.
constexpr std::size_t foresight = 8192;

/// The first `count` lines, all of which are there.
std::string_view first_lines(std::string_view text, std::size_t count) {
  std::size_t size = 0;
  for (; count > 0; --count) size = text.find('\n', size) + 1;
  return text.substr(0, size);
}

/// Cuts text into pieces that end with a line.
std::vector<std::string_view> pieces_of(std::string_view text) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t newline = text.find('\n', std::min(piece_size, text.size()) - 1);
    pieces.push_back(text.substr(0, newline + 1));
    text.remove_prefix(newline + 1);
  }
  return pieces;
}

template <class T>
void append_column(std::vector<T>& column, std::size_t room, const std::vector<RowBlock>& blocks, std::size_t count,
                   std::vector<std::vector<T>> RowBlock::*columns, std::size_t index) {
  if (column.capacity() < room) reserve_pages(column, room);
  for (std::size_t k = 0; k < count; ++k) {
    const T* const values = (blocks[k].*columns)[index].data();
    column.insert(column.end(), values, values + blocks[k].rows);
  }
}

}  // namespace

RowReader::RowReader(LineReader& lines, const FrameHeader& header, const std::string& label,
                     const TableRequest& request)
    : lines_(lines), header_(header), label_(label), converter_(header, request) {
  table_.first_line = lines.line_number() + 1;
  table_.real.resize(request.real.size());
  table_.whole.resize(request.whole.size());
}

DumpTable RowReader::read() {
  while (table_.rows < header_.rows) {
    const std::string_view text = lines_.lines();
    if (text.empty()) refuse_end();
    convert(text);
  }
  return std::move(table_);
}

/// About how many bytes the rows have that are not in the table yet; 0 where there is nothing to go by.
std::size_t RowReader::bytes_left() const {
  if (table_.rows == 0) return 0;
  const double per_row = static_cast<double>(bytes_) / static_cast<double>(table_.rows);
  constexpr double most = 1e18;
  return static_cast<std::size_t>(std::min(most, per_row * static_cast<double>(header_.rows - table_.rows)));
}

/// Converts lines that are at hand while more are read.
void RowReader::convert(std::string_view text) {
  const std::size_t threads = thread_count(), left = bytes_left();
  std::vector<std::string_view> pieces{text};
  std::size_t ahead = 0;
  if (threads > 1 && left > 0) {
    // Not what belongs to the next frames.
    if (left < text.size()) text = text.substr(0, text.find('\n', left - 1) + 1);
    pieces = pieces_of(text);
    ahead = std::min({left - std::min(left, text.size()), threads * batch_per_thread, largest_batch});
  }
  if (blocks_.size() < pieces.size()) blocks_.resize(pieces.size());
  const std::size_t most_rows = header_.rows - table_.rows;
  const auto convert_piece = [&](std::size_t k) {
    blocks_[k].rows = 0;
    converter_.convert(pieces[k], most_rows, blocks_[k]);
  };
  if (pieces.size() == 1 && ahead == 0) {
    convert_piece(0);
  } else {
    parallel_for(pieces.size() + 1, [&](std::size_t task) {
      if (task > 0)
        convert_piece(task - 1);
      else if (ahead > 0)
        lines_.read_ahead(ahead);
    });
  }
  take(text, pieces);
}

/// Takes over what was converted, in order, up to the end of the frame or the first line that is no row.
void RowReader::take(std::string_view text, const std::vector<std::string_view>& unconverted) {
  std::size_t rows = 0, count = 0;
  const char* end = text.data();
  bool stopped = false;
  while (count < unconverted.size() && !stopped && table_.rows + rows < header_.rows) {
    RowBlock& block = blocks_[count];
    const std::size_t wanted = header_.rows - table_.rows - rows;
    if (block.rows > wanted) {
      block.rows = wanted;
      end += first_lines({end, unconverted[count].data()}, wanted).size();
    } else {
      end = unconverted[count].data();
      stopped = !unconverted[count].empty();
    }
    rows += block.rows;
    ++count;
  }
  append(rows, count);
  const auto bytes = static_cast<std::size_t>(end - text.data());
  bytes_ += bytes;
  lines_.pass(bytes, rows);
  if (stopped && table_.rows < header_.rows) refuse_line();
}

/// Adds the rows of the first blocks to the table.
void RowReader::append(std::size_t rows, std::size_t blocks) {
  table_.rows += rows;
  if (room_ < table_.rows)
    room_ = std::min(header_.rows / foresight, table_.rows) == table_.rows ? foresight * table_.rows : header_.rows;
  const std::size_t reals = table_.real.size(), columns = reals + table_.whole.size();
  const auto append_to = [&](std::size_t c) {
    if (c < reals)
      append_column(table_.real[c], room_, blocks_, blocks, &RowBlock::real, c);
    else
      append_column(table_.whole[c - reals], room_, blocks_, blocks, &RowBlock::whole, c - reals);
  };
  if (blocks > 1) {
    parallel_for(columns, append_to);
  } else {
    for (std::size_t c = 0; c < columns; ++c) append_to(c);
  }
}

std::string RowReader::announced() const {
  return std::to_string(header_.rows) + " " + label_;
}

void RowReader::fail(const std::string& what, const std::string& found, const std::string& hint) const {
  throw InputError({{lines_.file(), lines_.line_number()}, what, found, announced(), hint});
}

void RowReader::refuse_end() {
  std::string_view line;
  if (!lines_.next(line))
    fail("the file ends within a frame", std::to_string(table_.rows) + " rows", cut_off_frame_hint);
  fail("the last line does not end in a newline, so the frame is incomplete", in_quotes(line), cut_off_frame_hint);
}

void RowReader::refuse_line() {
  std::string_view line;
  lines_.next(line);
  if (line.starts_with(item_mark))
    fail("the next frame begins too early", in_quotes(line) + " after " + std::to_string(table_.rows) + " rows", {});
  converter_.refuse(line, {lines_.file(), lines_.line_number()});
}

}  // namespace grainvdb
