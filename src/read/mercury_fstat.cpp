#include "read/mercury_fstat.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "grainvdb/error.hpp"
#include "read/mercury.hpp"
#include "read/row_reader.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr char mark = '#';
const std::string fstat_label = "contacts";

const std::vector<std::string>& written_columns() {
  static const std::vector<std::string> names{"t",   "P",   "I",  "cx", "cy", "cz", "overlap", "tangential overlap",
                                              "f_n", "f_t", "nx", "ny", "nz", "tx", "ty",      "tz"};
  return names;
}
enum Written : std::size_t {
  place_p = 1,
  place_i = 2,
  contact_point = 3,
  normal_force = 8,
  tangential_force = 9,
  normal = 10,
  tangent = 13
};
TableRequest needed_columns(bool with_walls) {
  TableRequest needed{
      {normal_force, tangential_force, normal, normal + 1, normal + 2, tangent, tangent + 1, tangent + 2},
      {place_p, place_i}};
  if (with_walls)
    for (std::size_t axis = 0; axis < 3; ++axis) needed.real.push_back(contact_point + axis);
  return needed;
}

/// What a contact has: ids, then the force and, with a wall, the contact point.
std::vector<std::string> given_columns(bool with_walls) {
  if (with_walls) return {"id", "fx", "fy", "fz", "cx", "cy", "cz"};
  return {"id1", "id2", "fx", "fy", "fz"};
}
std::size_t id_count(bool with_walls) {
  return with_walls ? 1 : 2;
}

/// The numbers of a line behind its mark; nothing when it is another line.
std::optional<std::vector<double>> marked_numbers(std::string_view line) {
  if (line.empty() || line.front() != mark) return std::nullopt;
  return mercury::numbers(line.substr(1));
}

/// Which rows are contacts of the wanted kind, in ascending order of P and I, each counted once: of the two lines of a
/// pair that with the lower place first. Throws InputError for a negative P and lines that come twice.
std::vector<std::size_t> counted_once(const DumpTable& rows, bool with_walls, const std::string& file) {
  const std::vector<std::int64_t>&p = rows.whole[0], &i = rows.whole[1];
  using Pair = std::tuple<std::int64_t, std::int64_t, std::size_t>;
  std::vector<Pair> pairs;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    if (p[row] < 0)
      throw InputError({{file, rows.first_line + row},
                        "a contact that does not begin with a particle",
                        std::to_string(p[row]),
                        "a number of 0 or more",
                        {}});
    if ((i[row] < 0) == with_walls) pairs.emplace_back(p[row], i[row], row);
  }
  std::sort(pairs.begin(), pairs.end());
  const auto same = [](const Pair& a, const Pair& b) {
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b);
  };
  const auto twice = std::adjacent_find(pairs.begin(), pairs.end(), same);
  if (twice != pairs.end())
    throw InputError(
        {{file, rows.first_line + std::get<2>(twice[1])},
         "the contact of " + std::to_string(std::get<0>(*twice)) + " with " + std::to_string(std::get<1>(*twice)) +
             " comes twice in one frame",
         "it also on line " + std::to_string(rows.first_line + std::get<2>(*twice)),
         with_walls ? "each contact with a wall once" : "each pair once in each order",
         with_walls ? "" : "Particles that touch each other through two sides of a periodic box are not supported"});
  std::vector<std::size_t> counted;
  for (const auto& [first, second, row] : pairs) {
    const auto reverse = std::lower_bound(pairs.begin(), pairs.end(), Pair{second, first, 0});
    const bool has_reverse =
        reverse != pairs.end() && std::get<0>(*reverse) == second && std::get<1>(*reverse) == first;
    if (first <= second || !has_reverse) counted.push_back(row);
  }
  return counted;
}

}  // namespace

bool MercuryFstat::recognise(std::string_view head) {
  for (const std::size_t fields : {2U, 6U, 6U}) {
    const std::size_t end = head.find('\n');
    const auto n = marked_numbers(head.substr(0, end));
    if (end == std::string_view::npos || !n || n->size() != fields) return false;
    head.remove_prefix(end + 1);
  }
  return true;
}

std::unique_ptr<DumpFile> MercuryFstat::open(std::unique_ptr<ByteStream> bytes, const std::string& file) {
  return std::make_unique<MercuryFstat>(LineReader(std::move(bytes), file));
}

/// The next line, which has to begin with the mark.
std::string_view MercuryFstat::comment_line() {
  std::string_view line;
  if (!lines_.next(line) || !lines_.complete() || !line.starts_with(mark))
    throw InputError({{lines_.file(), lines_.line_number()},
                      "the header of a frame is incomplete",
                      in_quotes(line),
                      "three lines that begin with #",
                      "The file was cut off, or is still being written"});
  return line;
}

std::optional<FrameHeader> MercuryFstat::next_header() {
  if (lines_.at_end()) return std::nullopt;
  FrameHeader header;
  header.start = lines_.position();
  header.start.frame = frame_;
  const std::string_view first = comment_line();
  const auto n = marked_numbers(first);
  if (!n || n->empty() || std::isnan((*n)[0]))
    throw InputError(
        {{lines_.file(), lines_.line_number()}, "the frame has no time", in_quotes(first), "# and the time", {}});
  header.time = (*n)[0];
  header.columns_line = lines_.line_number();
  comment_line();
  comment_line();
  header.kind = with_walls_ ? RowKind::wall_contacts : RowKind::contacts;
  header.step = mercury::first_step(lines_.file()) + static_cast<std::int64_t>(frame_++);
  header.columns = given_columns(with_walls_);

  rows_ = end_ = lines_.position();
  complete_ = true;
  std::string_view line;
  while (lines_.next(line)) {
    if (line.starts_with(mark)) break;
    ++header.rows;
    complete_ = lines_.complete();
    end_ = lines_.position();
  }
  lines_.seek(rows_);
  header_ = header;
  header_.columns = written_columns();
  return header;
}

bool MercuryFstat::skip_rows() {
  lines_.seek(end_);
  return complete_;
}

DumpTable MercuryFstat::read_rows(const TableRequest& request) {
  const DumpTable rows = RowReader(lines_, header_, fstat_label, needed_columns(with_walls_)).read();
  const std::vector<std::size_t> counted = counted_once(rows, with_walls_, lines_.file());
  const std::size_t ids = id_count(with_walls_);
  DumpTable table{counted.size(), rows.first_line, {}, {}};
  for (const std::size_t row : counted) table.lines.push_back(rows.line(row));
  for (const std::size_t column : request.whole) {
    if (column >= ids)
      throw InputError({{lines_.file(), header_.columns_line},
                        "forces stand for ids",
                        {},
                        with_walls_ ? "id" : "id1 and id2",
                        std::string("Check input.") + (with_walls_ ? "wall_contacts" : "contacts") +
                            ".columns in the pipeline file"});
    std::vector<std::int64_t>& to = table.whole.emplace_back();
    for (const std::size_t row : counted) to.push_back(rows.whole[column][row] + 1);
  }
  const double sign = with_walls_ ? -1 : 1;
  const auto value = [&](std::size_t column, std::size_t row) {
    if (column < ids) return static_cast<double>(rows.whole[column][row] + 1);
    const std::size_t k = column - ids;
    if (k >= 3) return rows.real[5 + k][row];
    return sign * (rows.real[0][row] * rows.real[2 + k][row] + rows.real[1][row] * rows.real[5 + k][row]);
  };
  for (const std::size_t column : request.real) {
    std::vector<double>& to = table.real.emplace_back();
    for (const std::size_t row : counted) to.push_back(value(column, row));
  }
  return table;
}

void MercuryFstat::seek(const TextPosition& start) {
  lines_.seek(start);
  frame_ = start.frame;
}

}  // namespace grainvdb
