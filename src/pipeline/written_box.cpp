#include "pipeline/written_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

[[noreturn]] void refuse_region(const Pipeline& pipeline) {
  throw ConfigError({pipeline.location("region"),
                     "the region has no voxel that a kernel reaches",
                     {},
                     "a box that material comes near to",
                     "Check region and lattice.origin"});
}

// Particles leave an open box until its bounds are next updated or they are removed: there is room for one cutoff
// beyond it, then for the kernel.
Topology::Bounds reach_of_boxes(const Lattice& lattice, const FrameSource& source, std::span<const std::size_t> wanted,
                                double cutoff) {
  Coord first;
  Coord last;
  std::int32_t* const firsts[] = {&first.x, &first.y, &first.z};
  std::int32_t* const lasts[] = {&last.x, &last.y, &last.z};
  for (int a = 0; a < 3; ++a) {
    if (const auto& period = lattice.period(a)) {
      *firsts[a] = period->first;
      *lasts[a] = period->first + period->count - 1;
      continue;
    }
    const auto axis = static_cast<std::size_t>(a);
    double lo = source.frames()[wanted.front()].box.lo[axis];
    double hi = source.frames()[wanted.front()].box.hi[axis];
    for (std::size_t k : wanted) {
      lo = std::min(lo, source.frames()[k].box.lo[axis]);
      hi = std::max(hi, source.frames()[k].box.hi[axis]);
    }
    *firsts[a] = static_cast<std::int32_t>(std::floor(lattice.to_index(a, lo - 2 * cutoff)));
    *lasts[a] = static_cast<std::int32_t>(std::ceil(lattice.to_index(a, hi + 2 * cutoff)));
  }
  return {first, last};
}

}  // namespace

void check_dense_size(const Topology::Bounds& bounds, const Pipeline& pipeline) {
  double voxels = 1;
  for (int a = 0; a < 3; ++a) voxels *= 1.0 + bounds.last[a] - bounds.first[a];
  if (voxels <= static_cast<double>(pipeline.limits.dense_voxels)) return;
  throw LimitError({pipeline.location("limits.dense_voxels"), "the box to be written has too many voxels",
                    std::to_string(static_cast<long long>(voxels)),
                    "at most limits.dense_voxels = " + std::to_string(pipeline.limits.dense_voxels),
                    "Choose larger voxels, leave stray particles out with select, or raise the limit"});
}

std::optional<Region> region_of(const Pipeline& pipeline, const Lattice& lattice) {
  if (!pipeline.region) return std::nullopt;
  Region region = Region::box(lattice, pipeline.region->first, pipeline.region->second);
  if (region.empty())
    throw ConfigError({pipeline.location("region"),
                       "the region lies between the centres of voxels",
                       {},
                       "a box that holds at least one centre",
                       "Make it larger than a voxel"});
  return region;
}

Topology::Bounds box_of_series(const Pipeline& pipeline, const Lattice& lattice, const FrameSource& source,
                               std::span<const std::size_t> wanted) {
  const Topology::Bounds all = reach_of_boxes(lattice, source, wanted, pipeline.cutoff);
  const std::optional<Region> region = region_of(pipeline, lattice);
  if (!region) return all;
  const std::optional<Topology::Bounds> part = region->clip(all);
  if (!part) refuse_region(pipeline);
  return *part;
}

Topology::Bounds box_of_voxels(const Pipeline& pipeline, const Topology& topology) {
  const std::optional<Topology::Bounds> bounds = topology.bounds();
  if (!bounds) refuse_region(pipeline);  // there is material, so that the region has left it all out
  return *bounds;
}

}  // namespace grainvdb
