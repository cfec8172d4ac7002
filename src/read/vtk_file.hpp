#pragma once
/// Legacy VTK files as VTK 9 writes them for LIGGGHTS: version 5.1, ASCII or BINARY, DATASET POLYDATA with VERTICES or
/// LINES, and one FIELD of POINT_DATA or CELL_DATA.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace grainvdb {

/// `components` numbers for each of `tuples` points or cells, one after another.
struct VtkArray {
  std::string name;
  std::size_t components = 1;
  std::size_t tuples = 0;
  std::vector<double> values;
};

struct VtkFile {
  VtkArray points;               ///< three components; where there are none, the file has nothing else
  bool of_cells = false;         ///< whether `fields` are of the lines between points, or of the points
  std::vector<VtkArray> fields;  ///< all with the same number of tuples
};

/// Whether a file begins as such a file does.
bool is_vtk_polydata(std::string_view head);

/// Reads a file from its whole content. Memory is taken for what is there, whatever the counts say. Throws InputError
/// that names the byte at which it is wrong.
VtkFile read_vtk(std::string_view content, const std::string& file);

}  // namespace grainvdb
