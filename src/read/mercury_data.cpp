#include "read/mercury_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "grainvdb/error.hpp"
#include "read/mercury.hpp"
#include "read/number.hpp"
#include "read/row_reader.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t fields_2d = 6, fields_3d = 8;  ///< of the line before the rows
const std::string data_label = "particles";

/// The columns that a row has, and behind them those that it does not have but that are known.
const std::vector<std::string>& written_columns(bool flat) {
  static const std::vector<std::string> two{"x", "y", "vx", "vy", "radius", "angle", "-omegaz", "type"},
      three{"x",      "y",      "z",      "vx",     "vy",     "vz",     "radius",
            "angle1", "angle2", "angle3", "omegax", "omegay", "omegaz", "type"};
  return flat ? two : three;
}
const std::vector<std::string>& known_columns(bool flat) {
  static const std::vector<std::string> two{"id", "omegaz", "z", "vz", "omegax", "omegay"}, three{"id"};
  return flat ? two : three;
}
enum Known : std::size_t { id, negated, zero };  ///< and all behind it

/// Whether these are the numbers of the line before the rows.
bool is_header(const std::optional<std::vector<double>>& n) {
  std::int64_t count = 0;
  return n && (n->size() == fields_2d || n->size() == fields_3d) && whole_of((*n)[0], count) && count >= 0 &&
         std::none_of(n->begin(), n->end(), [](double value) { return std::isnan(value); });
}

}  // namespace

/// A table of numbers has as many in the second line as in the first.
bool MercuryData::recognise(std::string_view head) {
  const std::size_t end = head.find('\n');
  const auto header = mercury::numbers(head.substr(0, end));
  if (end == std::string_view::npos || !is_header(header)) return false;
  const std::string_view rest = head.substr(end + 1);
  const std::size_t second_end = rest.find('\n');
  if (second_end == std::string_view::npos) return true;
  const auto second = mercury::numbers(rest.substr(0, second_end));
  return (*header)[0] == 0 || (second && second->size() != header->size());
}

std::unique_ptr<DumpFile> MercuryData::open(std::unique_ptr<ByteStream> bytes, const std::string& file) {
  return std::make_unique<MercuryData>(LineReader(std::move(bytes), file));
}

std::optional<FrameHeader> MercuryData::next_header() {
  FrameHeader header;
  header.start = lines_.position();
  header.start.frame = frame_;
  std::string_view line;
  if (!lines_.next(line)) return std::nullopt;
  const auto n = mercury::numbers(line);
  if (!is_header(n) || !lines_.complete())
    throw InputError({{lines_.file(), lines_.line_number()},
                      "this is not the line before the particles of a frame",
                      in_quotes(line),
                      "the number of particles, the time and the bounds of the box: 8 numbers, or 6 in two dimensions",
                      "The frame before it may have more or fewer particles than it says"});
  const bool flat = n->size() == fields_2d;
  const std::size_t axes = flat ? 2 : 3;
  for (std::size_t a = 0; a < axes; ++a) mercury::set_bounds(header.box, a, (*n)[2 + a], (*n)[2 + axes + a], lines_);
  header.unsaid.periodicity = true;
  header.unsaid.bounds[2] = flat;
  header.rows = static_cast<std::size_t>((*n)[0]);
  header.time = (*n)[1];
  header.step = mercury::first_step(lines_.file()) + static_cast<std::int64_t>(frame_);
  header.columns = written_columns(flat);
  header.columns_line = lines_.line_number();
  rows_ = header;
  header.columns.insert(header.columns.end(), known_columns(flat).begin(), known_columns(flat).end());
  ++frame_;
  return header;
}

bool MercuryData::skip_rows() {
  std::string_view line;
  for (std::size_t left = rows_.rows; left > 0; --left)
    if (!lines_.next(line) || !lines_.complete()) return false;
  return true;
}

DumpTable MercuryData::read_rows(const TableRequest& request) {
  const std::size_t written = rows_.columns.size();
  const bool flat = written == written_columns(true).size();
  const auto find = [&](std::string_view name) {
    const auto& names = rows_.columns;
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  // What the rows have is converted; what is only known takes its place afterwards.
  TableRequest there;
  const auto take = [&](const std::vector<std::size_t>& wanted, std::vector<std::size_t>& from) {
    for (const std::size_t column : wanted) {
      if (column < written) from.push_back(column);
      if (flat && column == written + negated) from.push_back(find("-omegaz"));
    }
  };
  take(request.real, there.real);
  take(request.whole, there.whole);
  DumpTable rows = RowReader(lines_, rows_, data_label, there).read();

  DumpTable table{rows.rows, rows.first_line, {}, {}};
  auto next = rows.real.begin();
  for (const std::size_t column : request.real) {
    if (column < written) {
      table.real.push_back(std::move(*next++));
    } else if (flat && column == written + negated) {
      for (double& omega : *next) omega = -omega;
      table.real.push_back(std::move(*next++));
    } else {
      table.real.emplace_back(rows.rows, 0.0);
    }
  }
  auto next_whole = rows.whole.begin();
  for (const std::size_t column : request.whole) {
    if (column < written) {
      table.whole.push_back(std::move(*next_whole++));
    } else {
      table.whole.emplace_back(rows.rows);
      std::iota(table.whole.back().begin(), table.whole.back().end(), std::int64_t{1});
    }
  }
  return table;
}

void MercuryData::seek(const TextPosition& start) {
  lines_.seek(start);
  frame_ = start.frame;
}

}  // namespace grainvdb
