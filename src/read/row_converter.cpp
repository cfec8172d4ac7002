#include "read/row_converter.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/row_kernel.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t skipped = ~std::size_t{0};

std::string_view token_at(const char* p, const char* end) {
  const char* q = p;
  while (q != end && !is_blank(*q)) ++q;
  return {p, static_cast<std::size_t>(q - p)};
}

const char* skip_blanks(const char* p, const char* end) {
  while (p != end && is_blank(*p)) ++p;
  return p;
}

/// The line at p without its newline, which must be there before `end`.
std::string_view line_at(const char* p, const char* end) {
  const void* newline = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
  return {p, static_cast<std::size_t>(static_cast<const char*>(newline) - p)};
}

}  // namespace

void RowBlock::make_room(std::size_t n) {
  const auto grow = [&](auto& column) {
    if (column.size() < n) column.resize(std::max(n, column.size() + column.size() / 2));
  };
  std::for_each(real.begin(), real.end(), grow);
  std::for_each(whole.begin(), whole.end(), grow);
}

RowConverter::RowConverter(const FrameHeader& header, const TableRequest& request)
    : header_(header), request_(request), fields_(header.columns.size()), by_column_(fields_, skipped) {
  for (std::size_t i = 0; i < request.real.size(); ++i) by_column_[request.real[i]] = i;
  for (std::size_t i = 0; i < request.whole.size(); ++i) by_column_[request.whole[i]] = request.real.size() + i;
}

void RowConverter::convert(std::string_view& lines, std::size_t most_rows, RowBlock& block) const {
  block.real.resize(request_.real.size());
  block.whole.resize(request_.whole.size());
  const char* p = lines.data();
  const char* const end = p + lines.size();
  LineIndex index;
  while (block.rows < most_rows && p != end) {
    index_lines(p, std::min(LineIndex::window, static_cast<std::size_t>(end - p)), index);
    const std::size_t there = std::min(index.lines, most_rows - block.rows);
    block.make_room(block.rows + std::max<std::size_t>(there, 1));
    const std::size_t rows = convert_columns(p, index, std::min(there, rows_in(p, index)), block);
    if (rows > 0) p += index.newlines[rows - 1] + 1;
    if (rows < there || there == 0) {
      // What the kernels do not take is either unusual or wrong.
      const std::string_view line = line_at(p, end);
      if (!convert_line(line, block)) break;
      p += line.size() + 1;
    }
  }
  lines.remove_prefix(static_cast<std::size_t>(p - lines.data()));
}

/// How many lines from the first on have as many tokens as there are columns and do not begin a section.
std::size_t RowConverter::rows_in(const char* text, const LineIndex& index) const {
  if (!index.plain) return 0;
  const std::size_t most = std::min(index.lines, index.tokens / fields_);
  const char* line = text;
  for (std::size_t row = 0; row < most; ++row) {
    const std::uint32_t newline = index.newlines[row];
    const std::size_t next = (row + 1) * fields_;
    if (index.starts[next - 1] > newline || index.starts[next] < newline) return row;
    if (std::memcmp(line, item_mark.data(), item_mark.size()) == 0) return row;
    line = text + newline + 1;
  }
  return most;
}

/// Adds rows to the block, up to one that is wrong; returns their number.
std::size_t RowConverter::convert_columns(const char* text, const LineIndex& index, std::size_t rows,
                                          RowBlock& block) const {
  std::array<std::uint32_t, LineIndex::window / 2> left;
  const auto settle = [&](std::size_t column, std::size_t n, auto* values, auto parse) {
    for (std::size_t i = 0; i < n && left[i] < rows; ++i) {
      const char* token = text + index.starts[left[i] * fields_ + column];
      if (parse(token, text + index.newlines[left[i]], values[left[i]]) == nullptr) rows = left[i];
    }
  };
  for (std::size_t i = 0; i < request_.real.size(); ++i) {
    const std::size_t column = request_.real[i];
    double* values = block.real[i].data() + block.rows;
    const std::size_t n = convert_reals(text, index.starts.data() + column, fields_, rows, values, left.data());
    settle(column, n, values, [](const char* p, const char* end, double& value) { return parse_real(p, end, value); });
  }
  for (std::size_t i = 0; i < request_.whole.size(); ++i) {
    const std::size_t column = request_.whole[i];
    std::int64_t* values = block.whole[i].data() + block.rows;
    const std::size_t n = convert_wholes(text, index.starts.data() + column, fields_, rows, values, left.data());
    settle(column, n, values,
           [](const char* p, const char* end, std::int64_t& value) { return parse_whole(p, end, value); });
  }
  block.rows += rows;
  return rows;
}

/// Adds one row to the block; false when it is wrong.
bool RowConverter::convert_line(std::string_view line, RowBlock& block) const {
  if (line.size() > longest_line || line.starts_with(item_mark)) return false;
  const char* const end = line.data() + line.size();
  const char* p = line.data();
  for (const std::size_t to : by_column_) {
    p = skip_blanks(p, end);
    if (p == end) return false;
    if (to == skipped)
      p += token_at(p, end).size();
    else if (to < request_.real.size())
      p = parse_real(p, end, block.real[to][block.rows]);
    else
      p = parse_whole(p, end, block.whole[to - request_.real.size()][block.rows]);
    if (p == nullptr) return false;
  }
  if (skip_blanks(p, end) != end) return false;
  ++block.rows;
  return true;
}

void RowConverter::refuse(std::string_view line, const Location& where) const {
  const char* const end = line.data() + line.size();
  const char* p = line.data();
  for (std::size_t column = 0; column < fields_; ++column) {
    p = skip_blanks(p, end);
    if (p == end) break;
    const std::string_view token = token_at(p, end);
    const std::size_t to = by_column_[column];
    const auto fail = [&](const std::string& expected, const std::string& hint) {
      throw InputError({where, "bad value in column " + header_.columns[column], in_quotes(token), expected, hint});
    };
    double real = 0;
    std::int64_t whole = 0;
    if (to < request_.real.size() && !parse_real(token, real)) fail("a finite decimal number", {});
    if (to >= request_.real.size() && to != skipped && !parse_whole(token, whole)) {
      const bool has_exponent = token.find_first_of("eE") != std::string_view::npos;
      fail("a whole number",
           has_exponent ? "An exponent may hide digits: print the column with 'dump_modify ... format' and %.0f or %d"
                        : "");
    }
    p += token.size();
  }
  std::size_t n = 0;
  for (std::string_view rest = line; !take_token(rest).empty();) ++n;
  throw InputError({where,
                    n < fields_ ? "the row is too short" : "the row is too long",
                    std::to_string(n) + " fields in " + in_quotes(line),
                    std::to_string(fields_) + " (" + joined(header_.columns) + ")",
                    {}});
}

}  // namespace grainvdb
