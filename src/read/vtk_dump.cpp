#include "read/vtk_dump.hpp"

#include <vector>

#include "grainvdb/error.hpp"
#include "read/file_number.hpp"
#include "read/number.hpp"

namespace grainvdb {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 18;

std::string all_of(ByteStream& bytes) {
  std::string content;
  for (std::size_t have = 0;; have = content.size()) {
    content.resize(have + chunk);
    content.resize(have + bytes.read(content.data() + have, chunk));
    if (content.size() == have) return content;
  }
}

}  // namespace

bool VtkDump::recognise(std::string_view head) {
  return is_vtk_polydata(head);
}

std::unique_ptr<DumpFile> VtkDump::open(std::unique_ptr<ByteStream> bytes, const std::string& file) {
  return std::make_unique<VtkDump>(std::move(bytes), file);
}

/// The columns of an array of one component bear its name, those of a vector an axis behind it, others a number.
void VtkDump::add_columns(const VtkArray& array, const std::string& stem) {
  for (std::size_t k = 0; k < array.components; ++k) {
    columns_.push_back({&array, k});
    header_.columns.push_back(array.components == 1   ? stem
                              : array.components == 3 ? stem + "xyz"[k]
                                                      : stem + '[' + std::to_string(k + 1) + ']');
  }
}

/// A contact is two points and a line or, where the contact point was put out, three points, all joined.
void VtkDump::count_contacts() {
  const std::size_t points = content_.points.tuples;
  const std::size_t lines = content_.fields.empty() ? 0 : content_.fields.front().tuples;
  const bool has_point = lines == points;
  if (has_point ? points % 3 != 0 : points != 2 * lines)
    throw InputError({{file_, 0},
                      "the lines are not those of contacts",
                      std::to_string(lines) + " lines, " + std::to_string(points) + " points",
                      "two points and a line, or three points and three lines, for each contact",
                      {}});
  lines_per_contact_ = has_point ? 3 : 1;
  header_.rows = lines / lines_per_contact_;
}

std::optional<FrameHeader> VtkDump::next_header() {
  if (begun_) return std::nullopt;
  bytes_->seek(0);
  content_ = read_vtk(all_of(*bytes_), file_);
  begun_ = true;
  columns_.clear();
  header_ = {};
  header_.start = {0, 0};
  const auto step = number_at_end(file_);
  if (!step)
    throw InputError({{file_, 0},
                      "the name of the file does not end with the timestep, and VTK files do not say it",
                      {},
                      "a name such as grains_40.vtk",
                      {}});
  header_.step = *step;
  header_.kind = content_.of_cells ? RowKind::contacts : RowKind::particles;
  if (content_.points.tuples == 0) {
    header_.kind = RowKind::contacts;
    header_.columns = {"id1", "id2", "fx", "fy", "fz"};
  } else if (content_.of_cells) {
    count_contacts();
  } else {
    lines_per_contact_ = 1;
    header_.rows = content_.points.tuples;
    header_.unsaid = {false, true, {true, true, true}};
    add_columns(content_.points, "");
  }
  for (const VtkArray& array : content_.fields)
    add_columns(array, content_.of_cells && array.name == "force" ? "f" : array.name);
  return header_;
}

DumpTable VtkDump::read_rows(const TableRequest& request) {
  DumpTable table{header_.rows, 1, {}, {}};
  const auto value = [&](std::size_t column, std::size_t row) {
    const Column& from = columns_[column];
    return from.array->values[row * lines_per_contact_ * from.array->components + from.component];
  };
  for (const std::size_t column : request.real) {
    std::vector<double>& to = table.real.emplace_back();
    for (std::size_t row = 0; row < table.rows; ++row) to.push_back(value(column, row));
  }
  for (const std::size_t column : request.whole) {
    std::vector<std::int64_t>& to = table.whole.emplace_back();
    for (std::size_t row = 0; row < table.rows; ++row) {
      const double number = value(column, row);
      if (!whole_of(number, to.emplace_back()))
        throw InputError({{file_, 0},
                          "bad value in column " + header_.columns[column] + " of row " + std::to_string(row + 1),
                          std::to_string(number),
                          "a whole number",
                          {}});
    }
  }
  return table;
}

}  // namespace grainvdb
