#pragma once
/// Half branches in the scenes of the splat's tests, and which of them reach a voxel.
#include <cstdint>
#include <functional>
#include <vector>

#include "grainvdb/moment.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb {

/// Half branches from random points, `shortest` to `longest` cutoffs long.
HalfBranches random_branches(const Scene& scene, std::size_t n, std::uint64_t seed, double shortest = 1.0 / 6,
                             double longest = 0.5);

/// Distance from the origin to the segment from p to p + a.
double segment_distance(const Vec3& p, const Vec3& a);

/// x - x_α for every image of the branch that reaches x.
std::vector<Vec3> images_in_reach(const Scene& scene, const Vec3& x, const Vec3& start, const Vec3& arm);

/// A half branch that reaches a voxel, with the mean of W along it.
struct BranchWeight {
  std::size_t branch = 0;
  double weight = 0;
};

/// A voxel and what reaches it.
struct ReachedVoxel {
  Coord voxel;
  std::vector<BranchWeight> branches;
};

/// All voxels that a branch could reach, and some more; `mean(p, a)` is the mean of W from p to p + a.
std::vector<ReachedVoxel> weigh_branches(const Scene& scene, const HalfBranches& branches,
                                         const std::function<double(const Vec3& p, const Vec3& a)>& mean);

}  // namespace grainvdb
