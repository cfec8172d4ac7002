#pragma once
/// The splat of a frame whose fields are exact averages over planes: onto a column of voxels along the normal of the
/// planes, with the kernel's marginal in place of the kernel, divided by the area of the planes.
#include <memory>
#include <span>

#include "grainvdb/frame.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/leaf_buffers.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/topology.hpp"
#include "pipeline/splat_groups.hpp"
#include "splat/plane_sums.hpp"

namespace grainvdb {

/// The box of that column, of one voxel along the planes: there everything repeats from voxel to voxel, so that
/// differences along the planes are 0 and interpolation along them does nothing.
Box box_of_planes(const Planes& planes, const Box& box, double voxel, const Vec3& origin);

class PlaneSplat {
 public:
  /// The lattice has the periods of box_of_planes. Lattice and kernel must outlive the splat.
  PlaneSplat(const Lattice& lattice, const LucyKernel& kernel, const Planes& planes)
      : lattice_(lattice), kernel_(kernel), planes_(planes) {}

  /// The voxels of the planes that the kernel reaches.
  std::shared_ptr<const Topology> topology(const Particles& particles) const;
  std::shared_ptr<const Topology> topology(const HalfBranches& branches) const;

  /// The sums of all values of a group, laid out as they are, with the channels of its kind.
  LeafBuffers splat(const SplatGroup& group, const Particles& particles, std::span<const double> q,
                    std::shared_ptr<const Topology> topology) const;
  LeafBuffers splat(const SplatGroup& group, const HalfBranches& branches, std::span<const double> q,
                    std::shared_ptr<const Topology> topology) const;

 private:
  PlaneSources sources(const Particles& particles) const;
  PlaneSources sources(const HalfBranches& branches) const;
  Coord voxel(std::int32_t plane) const;
  std::shared_ptr<const Topology> topology(const ReachedPlanes& planes) const;
  PlaneSums sums(const SplatGroup& group, const PlaneSources& points, std::span<const double> q) const;
  LeafBuffers in_leaves(const PlaneSums& sums, std::shared_ptr<const Topology> topology) const;

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  Planes planes_;
};

}  // namespace grainvdb
