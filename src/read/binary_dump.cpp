#include "read/binary_dump.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::int64_t longest_name = 64;
constexpr std::int32_t longest_text = 1 << 20;
constexpr std::int32_t most_columns = 4096;
constexpr std::uint32_t known_revision = 2;

template <class T>
T at(std::string_view head, std::size_t offset) {
  T value{};
  std::memcpy(&value, head.data() + offset, sizeof value);
  return value;
}

/// Old files have no signature: the numbers before the rows must be possible ones.
bool is_old_header(std::string_view head) {
  constexpr std::size_t flags = 16, bounds = 44, columns = 92, size = 100;
  if (head.size() < size || at<std::int64_t>(head, 0) < 0 || at<std::int64_t>(head, 8) < 0) return false;
  const auto tilted = at<std::int32_t>(head, flags);
  if (tilted != 0 && tilted != 1) return false;
  for (std::size_t side = 0; side < 6; ++side) {
    const auto kind = at<std::int32_t>(head, flags + 4 * (side + 1));
    if (kind < 0 || kind > 3) return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(at<double>(head, bounds + 16 * axis) < at<double>(head, bounds + 16 * axis + 8))) return false;
  if (tilted == 1) return true;
  return at<std::int32_t>(head, columns) >= 1 && at<std::int32_t>(head, columns) <= most_columns &&
         at<std::int32_t>(head, columns + 4) >= 0;
}

}  // namespace

bool BinaryDump::recognise(std::string_view head) {
  const bool is_new = head.size() > 8 && at<std::int64_t>(head, 0) < 0 && head.substr(8).starts_with("DUMP");
  return is_new || is_old_header(head);
}

std::unique_ptr<DumpFile> BinaryDump::open(std::unique_ptr<ByteStream> bytes, const std::string& file) {
  return std::make_unique<BinaryDump>(BinaryReader(std::move(bytes), file));
}

/// Reads the timestep and what stands before it. Returns the revision of the format, 0 where there is none.
std::uint32_t BinaryDump::read_format(std::int64_t& step) {
  step = reader_.number<std::int64_t>();
  if (step >= 0) return 0;
  if (step < -longest_name)
    reader_.fail("the frame does not begin as one of a binary LAMMPS dump", std::to_string(step),
                 "a timestep, or minus the length of a format name",
                 "Files from machines of the other byte order cannot be read: convert them there with binary2txt");
  const std::string name = reader_.text(static_cast<std::size_t>(-step));
  if (name != "DUMPATOM" && name != "DUMPCUSTOM")
    reader_.fail("an unknown kind of binary LAMMPS dump", in_quotes(name), "DUMPATOM or DUMPCUSTOM");
  if (const auto order = reader_.number<std::int32_t>(); order != 1)
    reader_.fail("the byte order is not that of this machine", std::to_string(order), "1",
                 "Convert the file with binary2txt on a machine like that of the run");
  const auto revision = reader_.number<std::uint32_t>();
  if (revision < 1 || revision > known_revision)
    reader_.fail("an unknown revision of the format", std::to_string(revision), "1 or 2",
                 "Convert the file with the binary2txt of the LAMMPS that wrote it");
  step = reader_.number<std::int64_t>();
  if (step < 0) reader_.fail("the timestep is below 0", std::to_string(step), "0 or more");
  return revision;
}

void BinaryDump::read_box(FrameHeader& header) {
  const auto tilted = reader_.number<std::int32_t>();
  if (tilted != 0 && tilted != 1) reader_.fail("the kind of the box is not known", std::to_string(tilted), "0 or 1");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto low = reader_.number<std::int32_t>(), high = reader_.number<std::int32_t>();
    if (low < 0 || low > 3 || high < 0 || high > 3 || (low == 0) != (high == 0))
      reader_.fail("the boundaries of the box are not understood", std::to_string(low) + " " + std::to_string(high),
                   "0 0 for a periodic axis, or two of 1, 2, 3");
    header.box.periodic[axis] = low == 0;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto low = reader_.number<double>(), high = reader_.number<double>();
    if (!(low < high) || !std::isfinite(high - low))
      reader_.fail(std::string("the box is empty along ") + "xyz"[axis],
                   std::to_string(low) + " ... " + std::to_string(high), "lo < hi, both finite");
    header.box.lo[axis] = low;
    header.box.hi[axis] = high;
  }
  for (int tilt = 0; tilted == 1 && tilt < 3; ++tilt)
    if (const auto value = reader_.number<double>(); value != 0)
      reader_.fail("the box is tilted (triclinic)", std::to_string(value), "an orthogonal box (all tilts 0)",
                   "Fields are gridded in orthogonal boxes only");
}

/// A text with its length before it.
std::string BinaryDump::read_text(const std::string& what) {
  const auto length = reader_.number<std::int32_t>();
  if (length < 0 || length > longest_text)
    reader_.fail("the length of the " + what + " cannot be meant", std::to_string(length),
                 "0 to " + std::to_string(longest_text));
  return reader_.text(static_cast<std::size_t>(length));
}

/// Units, time and columns, where the format has them.
void BinaryDump::read_names(FrameHeader& header) {
  const std::string units = read_text("units");
  if (!units.empty() && !is_name(units)) reader_.fail("the units cannot be meant", in_quotes(units), "a name");
  if (!units.empty()) header.units = units;
  if (reader_.number<char>() != 0) {
    header.time = reader_.number<double>();
    if (!std::isfinite(*header.time)) reader_.fail("the time is not finite", std::to_string(*header.time), "a number");
  }
  const std::string names = read_text("column names");
  std::string_view rest = names;
  std::vector<std::string> columns;
  for (std::string_view name = take_token(rest); !name.empty(); name = take_token(rest)) {
    if (!is_name(name)) reader_.fail("a column name that cannot be meant", in_quotes(name), "printable characters");
    columns.emplace_back(name);
  }
  if (columns.size() != header.columns.size())
    reader_.fail("the columns do not have a name each", std::to_string(columns.size()) + " names",
                 std::to_string(header.columns.size()));
  header.columns = std::move(columns);
}

std::optional<FrameHeader> BinaryDump::next_header() {
  if (reader_.at_end()) return std::nullopt;
  FrameHeader header;
  header.start = {reader_.position(), 0};
  const std::uint32_t revision = read_format(header.step);
  const auto rows = reader_.number<std::int64_t>();
  if (rows < 0) reader_.fail("the number of atoms is below 0", std::to_string(rows), "0 or more");
  header.rows = static_cast<std::size_t>(rows);
  read_box(header);
  const auto columns = reader_.number<std::int32_t>();
  if (columns < 1 || columns > most_columns)
    reader_.fail("the number of columns cannot be meant", std::to_string(columns),
                 "1 to " + std::to_string(most_columns));
  for (std::int32_t k = 1; k <= columns; ++k) header.columns.push_back("column " + std::to_string(k));
  if (revision >= known_revision)
    read_names(header);
  else
    header.unsaid.columns = true;
  chunks_ = reader_.number<std::int32_t>();
  if (chunks_ < 0) reader_.fail("the number of chunks is below 0", std::to_string(chunks_), "0 or more");
  header_ = header;
  return header;
}

/// The rows of the next chunk, when `left` rows are still to come.
std::size_t BinaryDump::next_chunk(std::size_t left) {
  const auto numbers = reader_.number<std::int32_t>();
  const auto columns = static_cast<std::int32_t>(header_.columns.size());
  if (numbers < 0 || numbers % columns != 0 || static_cast<std::size_t>(numbers / columns) > left)
    reader_.fail("a chunk of rows has a size that does not fit the frame", std::to_string(numbers) + " numbers",
                 "a multiple of " + std::to_string(columns) + " columns, for the " + std::to_string(left) + " of " +
                     std::to_string(header_.rows) + " atoms that are left");
  return static_cast<std::size_t>(numbers / columns);
}

bool BinaryDump::skip_rows() {
  std::size_t left = header_.rows;
  for (std::int32_t chunk = 0; chunk < chunks_; ++chunk) {
    if (reader_.at_end()) return false;
    const std::size_t rows = next_chunk(left);
    if (!reader_.skip(std::uint64_t{sizeof(double)} * rows * header_.columns.size())) return false;
    left -= rows;
  }
  return left == 0;
}

void BinaryDump::refuse_value(double value, std::size_t column, std::size_t row, const std::string& expected) const {
  reader_.fail("bad value in column " + header_.columns[column] + " of row " + std::to_string(row + 1) + ", which ends",
               std::to_string(value), expected);
}

void BinaryDump::take_row(const std::vector<double>& row, const TableRequest& request, DumpTable& table) const {
  for (std::size_t k = 0; k < request.real.size(); ++k) {
    const double value = row[request.real[k]];
    if (!std::isfinite(value)) refuse_value(value, request.real[k], table.rows, "a finite number");
    table.real[k].push_back(value);
  }
  for (std::size_t k = 0; k < request.whole.size(); ++k) {
    const double value = row[request.whole[k]];
    if (!whole_of(value, table.whole[k].emplace_back()))
      refuse_value(value, request.whole[k], table.rows, "a whole number");
  }
  ++table.rows;
}

DumpTable BinaryDump::read_rows(const TableRequest& request) {
  DumpTable table;
  table.first_line = 1;
  table.real.resize(request.real.size());
  table.whole.resize(request.whole.size());
  std::vector<double> row(header_.columns.size());
  for (std::int32_t chunk = 0; chunk < chunks_; ++chunk) {
    for (std::size_t left = next_chunk(header_.rows - table.rows); left > 0; --left) {
      reader_.read(row.data(), sizeof(double) * row.size());
      take_row(row, request, table);
    }
  }
  if (table.rows != header_.rows)
    reader_.fail("the frame ends too early", std::to_string(table.rows) + " rows",
                 std::to_string(header_.rows) + " atoms");
  return table;
}

}  // namespace grainvdb
