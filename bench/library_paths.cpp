#include "library_paths.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/grids.hpp"
#include "grainvdb/run.hpp"
#include "splat/splat.hpp"

namespace grainvdb::bench {
namespace {

/// As the library asks for it: the velocities are averages with the volume as weight.
std::vector<int> weights(int channels) {
  std::vector<int> weight_of(static_cast<std::size_t>(channels), -1);
  for (std::size_t c = 1; c < 4 && c < weight_of.size(); ++c) weight_of[c] = 0;
  return weight_of;
}

SparseField make_field(const Setting& setting, std::shared_ptr<const Topology> topology, int channels) {
  FieldMeta meta;
  meta.components = channels;
  return SparseField::unset(meta, std::move(topology), setting.lattice);
}

/// `values` are laid out [channel][offset].
void store(const double* values, std::size_t leaf, SparseField& field) {
  for (int c = 0; c < field.components(); ++c, values += leaf_size) {
    float* to = field.leaf(leaf, c);
    for (int v = 0; v < leaf_size; ++v) to[v] = static_cast<float>(values[v]);
  }
}

}  // namespace

Grids splat_to_grids(const Setting& setting, const Scene& scene, std::span<const double> q, int channels) {
  const Prepared prepared = prepare(setting, scene);
  return splat_particles_field({}, setting.lattice, setting.kernel, prepared.buckets, prepared.topology, q,
                               weights(channels))
      .grids()
      .components;
}

Prepared prepare(const Setting& setting, const Scene& scene) {
  Prepared prepared;
  prepared.buckets = bin_points(setting.lattice, scene.position, setting.kernel.cutoff());
  prepared.topology = particle_topology(setting.lattice, setting.kernel, prepared.buckets);
  return prepared;
}

void splat_prepared(const Setting& setting, const Prepared& prepared, std::span<const double> q, int channels) {
  splat_particles_fast(setting.lattice, setting.kernel, prepared.buckets, *prepared.topology, q, weights(channels),
                       [](std::size_t, const double*) {});
}

PreparedLeaves::PreparedLeaves(const Setting& setting, const Prepared& prepared, std::span<const double> q,
                               int channels)
    : leaves_(std::min(most, prepared.topology->leaf_count())),
      channels_(channels),
      voxel_(static_cast<float>(setting.lattice.voxel() / setting.kernel.cutoff())) {
  const Records records(prepared.buckets, q, weights(channels));
  stride_ = records.stride();
  const double reach = setting.kernel.cutoff() / setting.lattice.voxel();
  const std::size_t step = prepared.topology->leaf_count() / leaves_.size();
  for (std::size_t l = 0; l < leaves_.size(); ++l) {
    const std::size_t leaf = l * step + step / 2;
    const Coord& origin = prepared.topology->origin(leaf);
    gather_candidates(prepared.buckets, origin, reach, leaves_[l].candidates);
    records.gather(origin, leaves_[l].candidates, leaves_[l].records);
    leaves_[l].active = prepared.topology->mask(leaf);
    for (std::size_t k = 0; k < leaves_[l].candidates.count; ++k)
      leaves_[l].active.for_each([&](int offset) {
        const std::uint32_t e = leaves_[l].candidates.entry[k];
        const Coord at = voxel_at(origin, offset);
        double r2 = 0;
        for (int a = 0; a < 3; ++a) r2 += std::pow(at[a] - prepared.buckets.index[static_cast<std::size_t>(a)][e], 2);
        if (r2 < reach * reach) ++pairs_;
      });
  }
}

void PreparedLeaves::splat() {
  for (const Leaf& leaf : leaves_)
    for (int n = 0; n < passes; ++n)
      splat_leaf({&leaf.candidates, leaf.records.values.data(), stride_, channels_, voxel_}, leaf.active, sums_);
}

std::vector<ContactMethod> contact_methods() {
  // On half branches of c/6; those of the closed form are stored in single precision.
  return {{"adaptive", LineIntegral::adaptive(), 3e-5},
          {"exact", LineIntegral::exact(), 1e-6},
          {"gauss2", LineIntegral::gauss(2), 4e-4},
          {"gauss3", LineIntegral::gauss(3), 4e-5},
          {"gauss4", LineIntegral::gauss(4), 1.1e-5}};
}

Grids contacts_to_grids(const Setting& setting, const HalfBranches& branches, std::span<const double> q, int channels,
                        const ContactMethod& method) {
  const LeafBuffers sums = splat_contacts(setting.lattice, setting.kernel, branches, q, channels, method.integral);
  SparseField field = make_field(setting, sums.topology(), channels);
  for (std::size_t leaf = 0; leaf < sums.topology()->leaf_count(); ++leaf) store(sums.block(leaf, 0), leaf, field);
  return field.grids().components;
}

void run_pipeline_file(const std::string& file, const std::string& folder) {
  const Pipeline pipeline = load_pipeline(file);
  const Plan plan = make_plan(pipeline);
  const auto source = open_dumps(pipeline.input);
  std::vector<std::unique_ptr<FieldSink>> sinks;
  for (const std::string& format : pipeline.formats)
    for (const SinkInfo& sink : sink_registry())
      if (sink.name == format) sinks.push_back(sink.make(folder));
  run_pipeline(pipeline, plan, *source, sinks);
}

std::string instruction_set() {
  return splat_target();
}

}  // namespace grainvdb::bench
