#pragma once
/// Every call of the library that is measured.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grids.hpp"
#include "scene.hpp"

namespace grainvdb::bench {

/// Lattice and kernel of a scene at voxel size h.
struct Setting {
  explicit Setting(double h) : lattice(h, {0, 0, 0}), kernel(cutoff) {}
  Lattice lattice;
  LucyKernel kernel;
};

/// Particles to grids: sorted into leaves, active voxels found, splatted, stored in FloatGrids.
Grids splat_to_grids(const Setting& setting, const Scene& scene, std::span<const double> q, int channels);

/// What the kernel loop needs, made before the clock starts.
struct Prepared {
  Buckets buckets;
  std::shared_ptr<const Topology> topology;
};
Prepared prepare(const Setting& setting, const Scene& scene);

/// The kernel loop of all leaves, candidates and output included.
LeafBuffers splat_prepared(const Setting& setting, const Prepared& prepared, std::span<const double> q, int channels);

/// The instruction set of the splat.
std::string instruction_set();

}  // namespace grainvdb::bench
