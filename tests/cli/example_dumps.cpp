#include "cli/example_dumps.hpp"

#include <map>
#include <sstream>

namespace grainvdb::test {

std::string dump_text(int step, const std::string& columns) {
  std::ostringstream text;
  text << "ITEM: TIMESTEP\n"
       << step << "\nITEM: NUMBER OF ATOMS\n64\n"
       << "ITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 4\nITEM: ATOMS " << columns << '\n';
  for (int i = 0; i < 64; ++i) {
    const double x = 0.5 + i / 16, y = 0.5 + i / 4 % 4, z = 0.5 + i % 4;
    const std::map<std::string, double> values{{"id", i + 1},   {"type", 1 + i % 2}, {"x", x},  {"y", y},
                                               {"z", z},        {"vx", z},           {"vy", 0}, {"vz", 0},
                                               {"radius", 0.5}, {"mass", 2}};
    std::istringstream names(columns);
    for (std::string name; names >> name;) text << values.at(name) << ' ';
    text << '\n';
  }
  return text.str();
}

std::string contacts_text(int step) {
  std::ostringstream text;
  text << "ITEM: TIMESTEP\n"
       << step << "\nITEM: NUMBER OF ENTRIES\n64\n"
       << "ITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 4\nITEM: ENTRIES id1 id2 fx fy fz\n";
  for (int i = 0; i < 64; ++i) text << i + 1 << ' ' << 1 + i / 4 * 4 + (i + 1) % 4 << " 0 0 -1\n";
  return text.str();
}

void write_dumps(const Folder& folder) {
  for (int step : {0, 100, 200}) {
    folder.write("frames/dump" + std::to_string(step) + ".txt", dump_text(step));
    folder.write("frames/contacts" + std::to_string(step) + ".txt", contacts_text(step));
  }
}

std::string pipeline_text() {
  return "grainvdb: 1\n"
         "input:\n"
         "  particles: frames/dump*.txt\n"
         "  contacts: {files: frames/contacts*.txt}\n"
         "  units: si\n"
         "  dt: 1.0e-3\n"
         "lattice: {voxel: 0.5}\n"
         "kernel: {cutoff: 1.5}\n"
         "output: {fields: [phi, velocity]}\n";
}

void write_example(const Folder& folder) {
  write_dumps(folder);
  folder.write("p.yaml", pipeline_text());
}

}  // namespace grainvdb::test
