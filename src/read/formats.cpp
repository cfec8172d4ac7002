#include "read/formats.hpp"

#include <utility>

#include "grainvdb/error.hpp"
#include "read/binary_dump.hpp"
#include "read/foreign_formats.hpp"
#include "read/mercury_data.hpp"
#include "read/mercury_fstat.hpp"
#include "read/text_dump.hpp"
#include "read/vtk_dump.hpp"

namespace grainvdb {
namespace {

/// Enough for every signature; smaller than the first chunk of a line reader.
constexpr std::size_t head_size = 512;

}  // namespace

const std::vector<DumpFormat>& dump_formats() {
  static const std::vector<DumpFormat> formats{
      {"LAMMPS or LIGGGHTS text dump", &TextDump::recognise, &TextDump::open},
      {"binary LAMMPS dump", &BinaryDump::recognise, &BinaryDump::open},
      {"LIGGGHTS .vtk file", &VtkDump::recognise, &VtkDump::open},
      {"MercuryDPM .data file", &MercuryData::recognise, &MercuryData::open},
      {"MercuryDPM .fstat file", &MercuryFstat::recognise, &MercuryFstat::open},
  };
  return formats;
}

OpenedDump open_dump(const std::string& path, ReadCounters& counters) {
  OpenedBytes opened = open_bytes(path, counters.bytes_read);
  counters.files_opened.insert(path);
  OpenedDump result{nullptr, opened.compression, std::string(head_size, '\0')};
  std::size_t n = 0;
  while (n < head_size) {
    const std::size_t got = opened.bytes->read(result.head.data() + n, head_size - n);
    if (got == 0) break;
    n += got;
  }
  result.head.resize(n);
  for (const DumpFormat& format : dump_formats()) {
    if (!format.recognise(result.head)) continue;
    opened.bytes->seek(0);
    result.dump = format.open(std::move(opened.bytes), path);
    break;
  }
  return result;
}

void refuse_unrecognised(const std::string& path, const OpenedDump& file) {
  ForeignFile found = what_it_looks_like(file.head);
  if (file.compression == Compression::gzip) found.name += ", compressed with gzip";
  if (file.compression == Compression::zstd) found.name += ", compressed with zstd";
  std::string expected;
  for (const DumpFormat& format : dump_formats()) {
    if (!expected.empty()) expected += " or ";
    expected += "a " + std::string(format.name);
  }
  throw InputError({{path, 0},
                    "the file is not a dump that can be read",
                    found.name,
                    expected + ", plain or compressed (.gz, .zst)",
                    found.hint});
}

}  // namespace grainvdb
