#include "read/foreign_formats.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "read/number.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

using namespace std::string_view_literals;

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool starts_with_one_of(std::string_view text, std::initializer_list<std::string_view> starts) {
  return std::any_of(starts.begin(), starts.end(), [&](std::string_view start) { return text.starts_with(start); });
}

bool is_text(std::string_view head) {
  return std::all_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\r' || c == '\t';
  });
}

std::string_view take_line(std::string_view& text) {
  const std::size_t newline = text.find('\n');
  const std::string_view line = text.substr(0, newline);
  text.remove_prefix(newline == std::string_view::npos ? text.size() : newline + 1);
  return line;
}

/// XML with that attribute in its first VTKFile element.
bool is_vtk_xml(std::string_view head, std::string_view type) {
  const std::size_t element = head.find("<VTKFile");
  return element != std::string_view::npos && has(head.substr(element, 200), type);
}

/// A count, a comment, then rows of a name and three numbers.
bool is_xyz(std::string_view head) {
  std::string_view count = take_line(head);
  std::int64_t n = 0;
  if (!parse_whole(take_token(count), n) || !take_token(count).empty()) return false;
  take_line(head);
  std::string_view row = take_line(head);
  double value = 0;
  if (take_token(row).empty()) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (!parse_real(take_token(row), value)) return false;
  return true;
}

/// Two lines with the same number of commas, two at least.
bool is_csv(std::string_view head) {
  const std::string_view first = take_line(head), second = take_line(head);
  const auto commas = std::count(first.begin(), first.end(), ',');
  return commas >= 2 && (head.empty() || std::count(second.begin(), second.end(), ',') == commas);
}

bool is_pdb(std::string_view head) {
  return starts_with_one_of(head, {"HEADER    ", "CRYST1 ", "REMARK ", "MODEL    ", "ATOM   ", "HETATM"});
}

bool is_netcdf(std::string_view head) {
  return starts_with_one_of(head, {"CDF\x01"sv, "CDF\x02"sv, "CDF\x05"sv});
}

bool is_mercury_restart(std::string_view head) {
  return starts_with_one_of(head, {"restart_version", "MercuryDPM"});
}

bool is_mercury_energies(std::string_view head) {
  const std::string_view line = take_line(head);
  return has(line, "ene_kin") || has(line, "KineticEnergy");
}

constexpr const char* vtk_hint =
    "Of VTK files, grains and contacts can be read as LIGGGHTS writes them to names that end in .vtk: dump custom/vtk "
    "and dump local/gran/vtk";
constexpr const char* columns_hint = "Write a dump with the columns id x y z vx vy vz radius mass";
constexpr const char* unpack_hint = "Unpack it, or compress it with gzip or zstd";
constexpr const char* mercury_hint = "Of MercuryDPM files, name.data and name.fstat can be read";

struct Foreign {
  bool (*recognise)(std::string_view head);
  const char* name;
  const char* hint;
};

/// In the order in which they are tried.
constexpr std::array foreign_formats{
    Foreign{[](std::string_view h) { return h.empty(); }, "an empty file", ""},
    Foreign{[](std::string_view h) { return h.starts_with("\x89HDF\r\n\x1a\n"); }, "an HDF5 file", columns_hint},
    Foreign{is_netcdf, "a NetCDF file", columns_hint},
    Foreign{[](std::string_view h) { return h.starts_with("\xfd\x37zXZ"); }, "an xz-compressed file", unpack_hint},
    Foreign{[](std::string_view h) { return h.starts_with("BZh"); }, "a bzip2-compressed file", unpack_hint},
    Foreign{[](std::string_view h) { return h.starts_with("\x04\x22\x4d\x18"); }, "an lz4-compressed file",
            unpack_hint},
    Foreign{[](std::string_view h) {
              return starts_with_one_of(h, {"\x1f\x8b", "\x28\xb5\x2f\xfd"});
            },
            "a file that was compressed twice", unpack_hint},
    Foreign{[](std::string_view h) { return h.starts_with("PK\x03\x04"); }, "a zip archive", unpack_hint},
    Foreign{[](std::string_view h) { return h.size() > 262 && h.substr(257, 5) == "ustar"; }, "a tar archive",
            "Unpack it"},
    Foreign{[](std::string_view h) { return h.starts_with("\x93NUMPY"); }, "a NumPy array", columns_hint},
    Foreign{[](std::string_view h) { return h.starts_with("# vtk DataFile"); }, "a legacy VTK file", vtk_hint},
    Foreign{[](std::string_view h) { return is_vtk_xml(h, "\"Collection\""); }, "a ParaView collection (.pvd)",
            "It names other files: give those"},
    Foreign{[](std::string_view h) { return is_vtk_xml(h, "\"PolyData\""); }, "a VTK XML file (.vtp)", vtk_hint},
    Foreign{[](std::string_view h) { return is_vtk_xml(h, "\"UnstructuredGrid\""); }, "a VTK XML file (.vtu)",
            vtk_hint},
    Foreign{[](std::string_view h) { return is_vtk_xml(h, ""); }, "a VTK XML file", vtk_hint},
    Foreign{[](std::string_view h) { return h.starts_with("<?xml"); }, "an XML file", ""},
    Foreign{[](std::string_view h) {
              return starts_with_one_of(h, {"LAMMPS (", "LIGGGHTS ("});
            },
            "a log file", ""},
    Foreign{[](std::string_view h) { return has(h, " atoms\n") && has(h, " atom types\n"); }, "a LAMMPS data file",
            "Read it with read_data and write a dump"},
    Foreign{is_mercury_restart, "a MercuryDPM restart file", mercury_hint},
    Foreign{is_mercury_energies, "a MercuryDPM .ene file", mercury_hint},
    Foreign{is_pdb, "a PDB file", columns_hint},
    Foreign{is_xyz, "an XYZ file", columns_hint},
    Foreign{[](std::string_view h) {
              return starts_with_one_of(h, {"solid ", "facet "});
            },
            "an STL file", ""},
    Foreign{[](std::string_view h) { return !is_text(h); }, "binary data", ""},
    Foreign{is_csv, "a table of values separated by commas (CSV)", columns_hint},
};

}  // namespace

ForeignFile what_it_looks_like(std::string_view head) {
  const auto it = std::find_if(foreign_formats.begin(), foreign_formats.end(),
                               [&](const Foreign& foreign) { return foreign.recognise(head); });
  if (it != foreign_formats.end()) return {it->name, it->hint};
  return {"text that begins with " + in_quotes(take_line(head)), {}};
}

}  // namespace grainvdb
