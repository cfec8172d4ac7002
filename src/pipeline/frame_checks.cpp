#include "pipeline/frame_checks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <unistd.h>

#include "grainvdb/topology.hpp"
#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

// `who` names the one at an index.
void check_extent(const Material& material, const Columns3& position, const Lattice& lattice, const Pipeline& pipeline,
                  const std::function<std::string(std::size_t)>& who) {
  constexpr double indexable = 1e9;  // voxels; farther out, wrapping into a period leaves nothing but rounding
  const Box& box = material.box;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const bool periodic = box.periodic[a];
    const double limit = periodic ? indexable : static_cast<double>(pipeline.limits.extent);
    const double middle = lattice.to_index(a, 0.5 * (box.lo[axis] + box.hi[axis]));
    for (std::size_t i = 0; i < position[axis].size(); ++i) {
      const double x = position[axis][i];
      const double index = lattice.to_index(a, x);
      if (std::abs(index - middle) <= limit && std::abs(index) < indexable) continue;
      const bool inside = x >= box.lo[axis] && x <= box.hi[axis];
      const char* what = inside ? " is too many voxels from the middle of the box" : " lies too far from the box";
      const char* hint = "Leave the stray particle out with select, correct lattice.voxel, or raise limits.extent";
      if (periodic) hint = "Correct the coordinate, or leave the particle out with select";
      if (inside) hint = "Choose larger voxels, or raise limits.extent";
      throw LimitError(
          {{material.file, 0},
           who(i) + " of step " + std::to_string(material.step) + what,
           std::string(1, "xyz"[a]) + " = " + print_number(x) + " at lattice.voxel " + print_number(pipeline.voxel),
           "at most " + print_number(limit) + " voxels from its middle" + (periodic ? "" : ", limits.extent"),
           hint});
    }
  }
}

double memory_limit(const Limits& limits) {
  if (limits.memory_gb > 0) return limits.memory_gb * 1e9;
  return 0.75 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

double memory_needed(double leaves, const SplatMemory& memory) {
  const double summed = std::max(leaves, static_cast<double>(memory.summed_leaves));
  return leaves * leaf_size * sizeof(double) * memory.buffered + summed * static_cast<double>(memory.bytes_per_leaf);
}

}  // namespace

void check_extents(const Material& material, const Lattice& lattice, const Pipeline& pipeline) {
  for (const auto& [set, branches] : material.branches)
    check_extent(material, branches.start, lattice, pipeline,
                 [](std::size_t) { return std::string("a particle with contacts"); });
  check_extent(material, material.particles.position, lattice, pipeline,
               [&](std::size_t i) { return "particle " + std::to_string(material.particles.id[i]); });
}

void check_spread(const Material& material, const Lattice& lattice, const Pipeline& pipeline) {
  const Particles& p = material.particles;
  if (p.size() == 0) return;
  double voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto [lo, hi] = std::minmax_element(p.position[axis].begin(), p.position[axis].end());
    const auto& period = lattice.period(a);
    voxels *= period ? period->count : (*hi - *lo + pipeline.cutoff) / pipeline.voxel;
  }
  if (voxels <= static_cast<double>(pipeline.limits.dense_voxels)) return;
  throw LimitError({{material.file, 0},
                    "the material of step " + std::to_string(material.step) + " spans a box of too many voxels",
                    print_number(voxels),
                    "at most limits.dense_voxels = " + std::to_string(pipeline.limits.dense_voxels),
                    "Choose larger voxels, leave stray particles out with select, or raise the limit"});
}

bool fits(double leaves, const SplatMemory& memory, const Pipeline& pipeline) {
  return memory_needed(leaves, memory) <= memory_limit(pipeline.limits);
}

void check_memory(std::size_t leaves, const SplatMemory& memory, const Material& material, const Pipeline& pipeline) {
  if (fits(static_cast<double>(leaves), memory, pipeline)) return;
  const double need = memory_needed(static_cast<double>(leaves), memory);
  const double limit = memory_limit(pipeline.limits);
  throw LimitError(
      {{material.file, 0},
       "step " + std::to_string(material.step) + " needs more memory than is allowed",
       "at least " + std::to_string(need / 1e9) + " GB for " + std::to_string(leaves) + " leaves of 512 voxels",
       "at most " + std::to_string(limit / 1e9) + " GB",
       "Use larger voxels, fewer fields or shorter sliding windows, or raise limits.memory_gb"});
}

}  // namespace grainvdb
