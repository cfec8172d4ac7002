#pragma once
/// What LIGGGHTS writes with `dump custom/vtk` (grains) and `dump local/gran/vtk` (contacts) to names that end in .vtk.
///
/// The arrays v, f and omega are the columns vx vy vz, fx fy fz and omegax omegay omegaz, the points are x y z: they
/// have seven digits. Of contacts the array force is fx fy fz, on id1. Where the contact point was asked for, a contact
/// is three lines with the same data: the first counts. A file without points is a frame without contacts, as LIGGGHTS
/// leaves out everything else then.
///
/// The timestep is the number at the end of the file name; the input says what the box is.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "read/byte_stream.hpp"
#include "read/dump_file.hpp"
#include "read/vtk_file.hpp"

namespace grainvdb {

class VtkDump final : public DumpFile {
 public:
  VtkDump(std::unique_ptr<ByteStream> bytes, std::string file) : bytes_(std::move(bytes)), file_(std::move(file)) {}

  static bool recognise(std::string_view head);
  static std::unique_ptr<DumpFile> open(std::unique_ptr<ByteStream> bytes, const std::string& file);

  /// Reads the whole file, as the names of the arrays stand between their values.
  std::optional<FrameHeader> next_header() override;
  bool skip_rows() override { return true; }
  /// In place of lines rows are counted, from 1.
  DumpTable read_rows(const TableRequest& request) override;
  bool at_end() override { return begun_; }
  void seek(const TextPosition&) override { begun_ = false; }

 private:
  struct Column {
    const VtkArray* array;
    std::size_t component;
  };
  void add_columns(const VtkArray& array, const std::string& stem);
  void count_contacts();

  std::unique_ptr<ByteStream> bytes_;
  std::string file_;
  bool begun_ = false;
  VtkFile content_;
  std::vector<Column> columns_;
  std::size_t lines_per_contact_ = 1;
  FrameHeader header_;
};

}  // namespace grainvdb
