#include "library_paths.hpp"

#include "grainvdb/grids.hpp"
#include "splat/bricks.hpp"
#include "splat/splat.hpp"

namespace grainvdb::bench {
namespace {

/// As the library asks for it: the velocities are averages with the volume as weight.
std::vector<int> weights(int channels) {
  std::vector<int> weight_of(static_cast<std::size_t>(channels), -1);
  for (std::size_t c = 1; c < 4 && c < weight_of.size(); ++c) weight_of[c] = 0;
  return weight_of;
}

Grids to_grids(const Setting& setting, const LeafBuffers& sums) {
  FieldMeta meta;
  meta.components = sums.channels();
  SparseField field(meta, sums.topology(), setting.lattice);
  for (std::size_t leaf = 0; leaf < sums.topology()->leaf_count(); ++leaf)
    for (int c = 0; c < sums.channels(); ++c) {
      const double* from = sums.block(leaf, c);
      float* to = field.leaf(leaf, c);
      for (int v = 0; v < leaf_size; ++v) to[v] = static_cast<float>(from[v]);
    }
  return field.grids().components;
}

}  // namespace

Grids splat_to_grids(const Setting& setting, const Scene& scene, std::span<const double> q, int channels) {
  const Prepared prepared = prepare(setting, scene);
  return to_grids(setting, splat_prepared(setting, prepared, q, channels));
}

Prepared prepare(const Setting& setting, const Scene& scene) {
  Prepared prepared;
  prepared.buckets = bin_points(setting.lattice, scene.position, setting.kernel.cutoff());
  prepared.topology = particle_topology(setting.lattice, setting.kernel, prepared.buckets);
  return prepared;
}

LeafBuffers splat_prepared(const Setting& setting, const Prepared& prepared, std::span<const double> q, int channels) {
  return splat_particles_fast(setting.lattice, setting.kernel, prepared.buckets, prepared.topology, q,
                              weights(channels));
}

std::string instruction_set() {
  return splat_target();
}

}  // namespace grainvdb::bench
