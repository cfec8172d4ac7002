// A user of the installed library. Touches what pulls in each dependency: OpenVDB, HDF5, yaml-cpp and the
// decompressors.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <vector>

#include "grainvdb/error.hpp"
#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/grids.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/sparse_field.hpp"
#include "grainvdb/stage.hpp"
#include "grainvdb/version.hpp"

namespace {
void expect(bool condition, const char* what) {
  if (condition) return;
  std::cerr << "failed: " << what << '\n';
  std::exit(EXIT_FAILURE);
}
}  // namespace

int main() {
  using namespace grainvdb;
  const double pi = std::acos(-1.0);
  const LucyKernel kernel(2.0);
  expect(std::abs(kernel.value(0.0) - 105.0 / (16.0 * pi * 8.0)) < 1e-14, "W(0) = 105/(16 pi c^3)");

  const Lattice lattice(0.5, {1.0, 2.0, 3.0});
  expect(lattice.centre(Coord{2, 0, -1}) == Vec3{2.25, 2.25, 2.75}, "the centre of a voxel");

  const Stage* phi = StageRegistry::standard().find("phi");
  expect(phi != nullptr && phi->components == 1, "the stage phi");

  LeafMask mask;
  mask.set(leaf_offset({1, 2, 3}));
  const auto topology = std::make_shared<const Topology>(std::vector{Coord{0, 0, 0}}, std::vector{mask});
  const SparseField field({.name = "phi", .unit = "1", .description = "", .equation = ""}, topology, lattice);
  expect(field.grids().components.at(0)->activeVoxelCount() == 1, "the grid of a field");

  expect(sink_registry().at(0).name == "hdf5", "the HDF5 output");
  expect(pipeline_schema().find("\"cutoff\"") != std::string::npos, "the schema of pipeline files");
  try {
    open_dumps({.particles = {"no-such.dump"}, .units = "si"});
    expect(false, "a missing dump is an error");
  } catch (const Error&) {
  }

  std::cout << "grainvdb " << GRAINVDB_VERSION << " works from another project\n";
}
