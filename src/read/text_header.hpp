#pragma once
/// The header of one frame of a text dump, as a machine that takes one "ITEM:" section after another.
#include <optional>
#include <string>
#include <string_view>

#include "read/dump_file.hpp"
#include "read/line_reader.hpp"

namespace grainvdb {

/// Reads the sections of a frame's header in any order, up to and with the line that names the columns.
class TextHeaderReader {
 public:
  explicit TextHeaderReader(LineReader& lines) : lines_(lines) {}

  /// The header, or nothing when the file ends before it begins. Throws InputError.
  std::optional<FrameHeader> read();
  /// What the frame calls its rows.
  const std::string& label() const { return label_; }

 private:
  bool next_section(std::string_view& name);
  void section(std::string_view name);
  std::string_view value_line(std::string_view item);
  std::string_view single_value(std::string_view item);
  void once(bool& seen, std::string_view item);
  void read_units();
  void read_time();
  void read_step();
  void read_count(std::string_view label);
  void read_box(std::string_view text);
  void read_bounds(std::size_t axis, bool tilted);
  void read_columns(std::string_view text);
  [[noreturn]] void fail(const std::string& what, const std::string& found, const std::string& expected,
                         const std::string& hint = {}) const;

  LineReader& lines_;
  FrameHeader header_;
  std::string label_;
  bool has_units_ = false, has_time_ = false, has_step_ = false, has_count_ = false, has_box_ = false, done_ = false;
};

}  // namespace grainvdb
