#include "dumps.hpp"

#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "scene.hpp"

namespace grainvdb::bench {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

File create(const std::string& path) {
  File file(std::fopen(path.c_str(), "w"));
  if (!file) throw std::runtime_error("cannot write " + path);
  return file;
}

void write_header(std::FILE* file, const Scene& scene, std::size_t step, const char* what, std::size_t rows) {
  std::fprintf(file, "ITEM: UNITS\nlj\nITEM: TIME\n%g\nITEM: TIMESTEP\n%zu\nITEM: NUMBER OF %s\n%zu\n",
               1e-3 * static_cast<double>(step), step, what, rows);
  std::fprintf(file, "ITEM: BOX BOUNDS ff ff ff\n");
  for (int a = 0; a < 3; ++a) std::fprintf(file, "%g %g\n", -1.0, scene.edge + 1);
}

void write_particles(std::FILE* file, const Scene& scene, std::size_t step) {
  write_header(file, scene, step, "ATOMS", scene.size());
  std::fprintf(file, "ITEM: ATOMS id type x y z vx vy vz omegax omegay omegaz radius mass\n");
  for (std::size_t i = 0; i < scene.size(); ++i) {
    std::fprintf(file, "%zu 1", i + 1);
    for (const Columns3* columns : {&scene.position, &scene.velocity, &scene.spin})
      for (const auto& column : *columns) std::fprintf(file, " %.9g", column[i]);
    const double d = scene.diameter[i];
    std::fprintf(file, " %.9g %.9g\n", d / 2, std::numbers::pi / 6 * d * d * d);
  }
}

void write_contacts(std::FILE* file, const Scene& scene, const Branches& branches, std::size_t step) {
  write_header(file, scene, step, "ENTRIES", branches.size() / 2);
  std::fprintf(file, "ITEM: ENTRIES id1 id2 fx fy fz px py pz\n");
  for (std::size_t b = 0; b < branches.size(); b += 2) {
    std::fprintf(file, "%u %u", branches.particle[b] + 1, branches.particle[b + 1] + 1);
    for (const auto& force : branches.force) std::fprintf(file, " %.9g", force[b]);
    for (std::size_t a = 0; a < 3; ++a) std::fprintf(file, " %.9g", branches.start[a][b] - branches.arm[a][b]);
    std::fprintf(file, "\n");
  }
}

constexpr const char* pipeline = R"(grainvdb: 1
input:
  particles: particles*.dump
  contacts:
    files: contacts*.dump
    columns: {id1: id1, id2: id2, force: [fx, fy, fz], point: [px, py, pz]}
lattice: {voxel: 0.5}
kernel: {cutoff: 3}
average: {window: all}
output:
  fields: [phi, velocity, mean_diameter, temperature, stress, shear_rate, pressure, shear_stress, mu, inertial_number,
           fluidity, gd_over_dv]
  formats: [hdf5]
)";

}  // namespace

std::string write_dumps(std::size_t particles, std::size_t frames, const std::string& folder) {
  Scene scene = make_scene(particles);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const std::string end = std::to_string(frame) + ".dump";
    write_particles(create(folder + "/particles" + end).get(), scene, frame);
    write_contacts(create(folder + "/contacts" + end).get(), scene, make_branches(scene), frame);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < scene.size(); ++i) scene.position[a][i] += 0.01 * scene.velocity[a][i];
  }
  const std::string path = folder + "/pipeline.yaml";
  std::fputs(pipeline, create(path).get());
  return path;
}

}  // namespace grainvdb::bench
