#pragma once
/// One dump file of any format, read frame by frame.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/box.hpp"
#include "read/line_reader.hpp"

namespace grainvdb {

/// What the rows of a frame are.
enum class RowKind {
  particles,
  contacts,      ///< between particles; or with walls, which text dumps do not tell apart
  wall_contacts  ///< with walls that are no particles
};

/// What a frame does not say of itself, so that the input has to.
struct Unsaid {
  bool columns = false;      ///< FrameHeader::columns has placeholders
  bool periodicity = false;  ///< which axes are periodic
  std::array<bool, 3> bounds{};
};

/// What stands before the rows of a frame. Line numbers serve error messages.
struct FrameHeader {
  TextPosition start;  ///< where the frame begins
  std::int64_t step = 0;
  std::optional<double> time;        ///< [time]
  std::optional<std::string> units;  ///< as the file names them
  std::size_t units_line = 0;
  Box box;
  RowKind kind = RowKind::particles;
  std::size_t rows = 0;  ///< as announced; not to be trusted with memory
  std::vector<std::string> columns;
  std::size_t columns_line = 0;
  Unsaid unsaid;
};

/// The columns to convert, by their number in the file; each column is in one list at most, once. All others are
/// skipped.
struct TableRequest {
  std::vector<std::size_t> real;
  std::vector<std::size_t> whole;
};

/// The converted columns of a frame, in the order of the request.
struct DumpTable {
  std::size_t rows = 0;
  std::size_t first_line = 0;
  std::vector<std::vector<double>> real;
  std::vector<std::vector<std::int64_t>> whole;
  std::vector<std::size_t> lines{};  ///< of the rows, where these are not those from first_line on

  std::size_t line(std::size_t row) const { return lines.empty() ? first_line + row : lines[row]; }
};

class DumpFile {
 public:
  virtual ~DumpFile() = default;

  /// Before anything is read: which rows a file gives that holds those of several kinds. Others give what they have.
  virtual void choose(RowKind /*wanted*/) {}

  /// Reads the header of the frame that begins here; nothing at the end of the file. Throws InputError.
  virtual std::optional<FrameHeader> next_header() = 0;

  /// After next_header: passes over the rows without converting them. Returns false when the file or the next frame
  /// comes before the last announced row has ended; read_rows says what is wrong.
  virtual bool skip_rows() = 0;

  /// After next_header: converts the requested columns of all rows. Every row must have as many fields as the header
  /// has columns, and exactly the announced number of rows must be there; throws InputError otherwise.
  virtual DumpTable read_rows(const TableRequest& request) = 0;

  /// Whether nothing follows. After skip_rows or read_rows.
  virtual bool at_end() = 0;

  /// Goes to the start of a frame.
  virtual void seek(const TextPosition& start) = 0;
};

}  // namespace grainvdb
