#include "pipeline/plane_splat.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

namespace grainvdb {
namespace {

Coord with_plane(int axis, std::int32_t plane, std::int32_t across) {
  Coord c{across, across, across};
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) = plane;
  return c;
}

/// Single precision is exact to a part of the sum of magnitudes: what has a weight is summed about its weighted mean,
/// which a large mean velocity does not hide then.
PlaneSums sums_about_means(const SplatGroup& group, const PlaneSources& points, std::span<const double> q) {
  const auto width = static_cast<std::size_t>(group.value_count());
  std::vector<double> total(width), reference(width), about(q.begin(), q.end());
  for (std::size_t n = 0; n < q.size(); ++n) total[n % width] += q[n];
  const auto weight_of = [&](std::size_t c) { return static_cast<std::size_t>(group.weight_of[c]); };
  for (std::size_t c = 0; c < width; ++c)
    if (group.weight_of[c] >= 0 && total[weight_of(c)] > 0) reference[c] = total[c] / total[weight_of(c)];
  for (std::size_t n = 0; n < q.size(); ++n)
    if (const std::size_t c = n % width; reference[c] != 0) about[n] -= reference[c] * q[n - c + weight_of(c)];
  PlaneSums sums =
      splat_planes(points.lattice, points.kernel, points.axis, points.start, about, static_cast<int>(width));
  for (std::size_t n = 0; n < sums.values.size(); ++n)
    if (const std::size_t c = n % width; reference[c] != 0)
      sums.values[n] += reference[c] * sums.values[n - c + weight_of(c)];
  return sums;
}

/// Channel 3 v + j for value v and axis j, of which that of the planes alone is not 0.
PlaneSums gradients(const PlaneSums& along, int axis) {
  PlaneSums all;
  all.first = along.first;
  all.channels = 3 * along.channels;
  all.values.resize(3 * along.values.size());
  for (std::size_t n = 0; n < along.values.size(); ++n)
    all.values[3 * n + static_cast<std::size_t>(axis)] = along.values[n];
  return all;
}

}  // namespace

Box box_of_planes(const Planes& planes, const Box& box, double voxel, const Vec3& origin) {
  Box column = box;
  for (std::size_t a = 0; a < 3; ++a) {
    if (static_cast<int>(a) == planes.axis) continue;
    column.lo[a] = origin[a];
    column.hi[a] = origin[a] + voxel;
    column.periodic[a] = true;
  }
  return column;
}

PlaneSources PlaneSplat::sources(const Particles& particles) const {
  return {lattice_, kernel_, planes_.axis, particles.position[static_cast<std::size_t>(planes_.axis)]};
}

PlaneSources PlaneSplat::sources(const HalfBranches& branches) const {
  const auto axis = static_cast<std::size_t>(planes_.axis);
  return {lattice_, kernel_, planes_.axis, branches.start[axis], &branches.arm[axis]};
}

std::shared_ptr<const Topology> PlaneSplat::topology(const Particles& particles) const {
  return topology(reached_planes(sources(particles)));
}

std::shared_ptr<const Topology> PlaneSplat::topology(const HalfBranches& branches) const {
  return topology(reached_planes(sources(branches)));
}

/// Of a period of one voxel along the planes, the first is 0.
Coord PlaneSplat::voxel(std::int32_t plane) const {
  return with_plane(planes_.axis, plane, 0);
}

std::shared_ptr<const Topology> PlaneSplat::topology(const ReachedPlanes& planes) const {
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (std::size_t n = 0; n < planes.reached.size(); ++n) {
    if (planes.reached[n] == 0) continue;
    const Coord c = voxel(planes.first + static_cast<std::int32_t>(n));
    if (origins.empty() || origins.back() != leaf_origin(c)) {
      origins.push_back(leaf_origin(c));
      masks.emplace_back();
    }
    masks.back().set(leaf_offset(c));
  }
  return std::make_shared<const Topology>(std::move(origins), std::move(masks));
}

PlaneSums PlaneSplat::sums(const SplatGroup& group, const PlaneSources& points, std::span<const double> q) const {
  switch (group.kind()) {
    case Moment::Kind::particles:
      return group.buffered() ? sum_on_planes(points, q, group.value_count()) : sums_about_means(group, points, q);
    case Moment::Kind::particle_gradients:
      return gradients(sum_gradients_on_planes(points, q, group.value_count()), planes_.axis);
    case Moment::Kind::second_moments:
      return sum_second_moments_on_planes(points, q);
    case Moment::Kind::particle_squares:
    case Moment::Kind::contacts:
    case Moment::Kind::voxels:
      break;
  }
  throw std::logic_error("the moment '" + group.moments[0]->name + "' has no sum over planes of grains");
}

LeafBuffers PlaneSplat::splat(const SplatGroup& group, const Particles& particles, std::span<const double> q,
                              std::shared_ptr<const Topology> topology) const {
  return in_leaves(sums(group, sources(particles), q), std::move(topology));
}

LeafBuffers PlaneSplat::splat(const SplatGroup& group, const HalfBranches& branches, std::span<const double> q,
                              std::shared_ptr<const Topology> topology) const {
  return in_leaves(sum_branches_on_planes(sources(branches), q, group.value_count()), std::move(topology));
}

LeafBuffers PlaneSplat::in_leaves(const PlaneSums& sums, std::shared_ptr<const Topology> topology) const {
  LeafBuffers result(topology, sums.channels);
  for (std::size_t leaf = 0; leaf < topology->leaf_count(); ++leaf)
    topology->mask(leaf).for_each([&](int offset) {
      const std::int64_t row = std::int64_t{voxel_at(topology->origin(leaf), offset)[planes_.axis]} - sums.first;
      if (row < 0 || row >= static_cast<std::int64_t>(sums.planes())) return;  // of a species, that does not reach it
      for (int c = 0; c < sums.channels; ++c)
        result.block(leaf, c)[offset] = sums.value(static_cast<std::size_t>(row), c) / planes_.area;
    });
  return result;
}

}  // namespace grainvdb
