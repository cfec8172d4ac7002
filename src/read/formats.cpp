#include "read/formats.hpp"

#include <array>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/text_dump.hpp"

namespace grainvdb {
namespace {

/// Enough for every signature; smaller than the first chunk of a line reader.
constexpr std::size_t head_size = 512;

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_text(std::string_view head) {
  for (const char c : head)
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t') return false;
  return true;
}

/// The first line of a MercuryDPM .data file: count, time and six bounds, all numbers.
bool is_mercury_data(std::string_view head) {
  std::string_view line = head.substr(0, head.find('\n'));
  std::size_t numbers = 0;
  for (std::string_view token = take_token(line); !token.empty(); token = take_token(line), ++numbers) {
    double value = 0;
    if (!parse_real(token, value)) return false;
  }
  return numbers == 8;
}

bool is_lammps_binary(std::string_view head) {
  const std::string_view start = head.substr(0, 64);
  return has(start, "DUMPCUSTOM") || has(start, "DUMPATOM");
}

struct Foreign {
  bool (*recognise)(std::string_view head);
  std::string_view name;
};

constexpr std::array foreign_formats{
    Foreign{[](std::string_view h) { return h.empty(); }, "an empty file"},
    Foreign{[](std::string_view h) { return h.starts_with("\x89HDF\r\n\x1a\n"); }, "an HDF5 file"},
    Foreign{[](std::string_view h) { return h.starts_with("CDF\x01") || h.starts_with("CDF\x02"); }, "a NetCDF file"},
    Foreign{[](std::string_view h) {
              return h.starts_with(
                  "\xfd"
                  "7zXZ");
            },
            "an xz-compressed file"},
    Foreign{[](std::string_view h) { return h.starts_with("BZh"); }, "a bzip2-compressed file"},
    Foreign{[](std::string_view h) { return h.starts_with("PK\x03\x04"); }, "a zip archive"},
    Foreign{is_lammps_binary, "a binary LAMMPS dump"},
    Foreign{[](std::string_view h) { return h.starts_with("# vtk DataFile"); }, "a legacy VTK file"},
    Foreign{[](std::string_view h) { return has(h, "<VTKFile"); }, "a VTK XML file"},
    Foreign{[](std::string_view h) { return h.starts_with("LAMMPS (") || h.starts_with("LIGGGHTS ("); }, "a log file"},
    Foreign{[](std::string_view h) { return has(h, " atoms\n") && has(h, " atom types\n"); }, "a LAMMPS data file"},
    Foreign{is_mercury_data, "a MercuryDPM .data file"},
    Foreign{[](std::string_view h) { return !is_text(h); }, "binary data"},
};

}  // namespace

const std::vector<DumpFormat>& dump_formats() {
  static const std::vector<DumpFormat> formats{
      {"LAMMPS or LIGGGHTS text dump", &TextDump::recognise, &TextDump::open},
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
    result.dump = format.open(LineReader(std::move(opened.bytes), path));
    break;
  }
  return result;
}

void refuse_unrecognised(const std::string& path, std::string_view head) {
  std::string found;
  for (const Foreign& foreign : foreign_formats) {
    if (!foreign.recognise(head)) continue;
    found = foreign.name;
    break;
  }
  if (found.empty()) found = "text that begins with " + in_quotes(head.substr(0, head.find('\n')));
  std::string expected;
  for (const DumpFormat& format : dump_formats()) {
    if (!expected.empty()) expected += " or ";
    expected += "a " + std::string(format.name);
  }
  throw InputError({{path, 0},
                    "the file is not a dump that can be read",
                    found,
                    expected + ", plain or compressed (.gz, .zst)",
                    {}});
}

}  // namespace grainvdb
