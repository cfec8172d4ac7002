#pragma once
/// Binary LAMMPS dumps (`dump atom` and `dump custom` to a name that ends in .bin), as tools/binary2txt.cpp of LAMMPS
/// reads them.
///
/// A frame begins with its timestep. Since 2021 there stand before it minus the length of a name (DUMPATOM,
/// DUMPCUSTOM), the name, 1 as an int, which shows the byte order, and the revision of the format; from revision 2 on
/// the frame also has the units, the time and the names of the columns. Older files leave those to the input. The rows
/// follow as doubles, in one chunk for each process of the run.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "read/binary_reader.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

class BinaryDump final : public DumpFile {
 public:
  explicit BinaryDump(BinaryReader reader) : reader_(std::move(reader)) {}

  static bool recognise(std::string_view head);
  static std::unique_ptr<DumpFile> open(std::unique_ptr<ByteStream> bytes, const std::string& file);

  std::optional<FrameHeader> next_header() override;
  bool skip_rows() override;
  /// In place of lines rows are counted, from 1.
  DumpTable read_rows(const TableRequest& request) override;
  bool at_end() override { return reader_.at_end(); }
  void seek(const TextPosition& start) override { reader_.seek(start.offset); }

 private:
  std::uint32_t read_format(std::int64_t& step);
  void read_box(FrameHeader& header);
  void read_names(FrameHeader& header);
  std::string read_text(const std::string& what);
  std::size_t next_chunk(std::size_t left);
  void take_row(const std::vector<double>& row, const TableRequest& request, DumpTable& table) const;
  [[noreturn]] void refuse_value(double value, std::size_t column, std::size_t row, const std::string& expected) const;

  BinaryReader reader_;
  FrameHeader header_;       ///< of the frame whose rows come next
  std::int32_t chunks_ = 0;  ///< that its rows come in
};

}  // namespace grainvdb
