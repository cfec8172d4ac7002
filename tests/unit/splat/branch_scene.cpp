#include "unit/splat/branch_scene.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace grainvdb {

HalfBranches random_branches(const Scene& scene, std::size_t n, std::uint64_t seed, double shortest, double longest) {
  HalfBranches b;
  b.start = scene.random_positions(n, seed);
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(shortest, longest);
  for (std::size_t k = 0; k < n; ++k) {
    Vec3 a{normal(random), normal(random), normal(random)};
    const double scale = scene.cutoff * uniform(random) / norm(a);
    for (std::size_t j = 0; j < 3; ++j) {
      b.arm[j].push_back(a[j] * scale);
      b.force[j].push_back(normal(random));
    }
  }
  return b;
}

double segment_distance(const Vec3& p, const Vec3& a) {
  const double length2 = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  const double along = length2 > 0 ? -(p[0] * a[0] + p[1] * a[1] + p[2] * a[2]) / length2 : 0;
  const double s = std::clamp(along, 0.0, 1.0);
  return norm({p[0] + s * a[0], p[1] + s * a[1], p[2] + s * a[2]});
}

std::vector<Vec3> images_in_reach(const Scene& scene, const Vec3& x, const Vec3& start, const Vec3& arm) {
  const Vec3 middle{start[0] - arm[0] / 2, start[1] - arm[1] / 2, start[2] - arm[2] / 2};
  const Vec3 d = scene.shortest(x, middle);
  const double reach = scene.cutoff + norm(arm) / 2;
  // About the image with the nearest middle, as many to each side as may reach.
  const auto shifts = [&](int axis) {
    const double l = scene.box.length(axis);
    std::vector<double> result{0};
    if (scene.box.periodic[static_cast<std::size_t>(axis)])
      for (int k = 1; k * l - l / 2 < reach; ++k) {
        result.push_back(-k * l);
        result.push_back(k * l);
      }
    return result;
  };
  std::vector<Vec3> result;
  for (const double i : shifts(0))
    for (const double j : shifts(1))
      for (const double k : shifts(2)) {
        const Vec3 from_middle{d[0] + i, d[1] + j, d[2] + k};
        if (norm(from_middle) >= reach) continue;
        const Vec3 p{from_middle[0] - arm[0] / 2, from_middle[1] - arm[1] / 2, from_middle[2] - arm[2] / 2};
        if (segment_distance(p, arm) < scene.cutoff) result.push_back(p);
      }
  return result;
}

std::vector<ReachedVoxel> weigh_branches(const Scene& scene, const HalfBranches& branches,
                                         const std::function<double(const Vec3& p, const Vec3& a)>& mean) {
  const Lattice lattice = scene.lattice();
  double longest = 0;
  for (std::size_t b = 0; b < branches.size(); ++b) longest = std::max(longest, norm(row(branches.arm, b)));
  std::vector<ReachedVoxel> result;
  for (const Coord& voxel : scene.voxels(scene.cutoff + longest + 2 * scene.voxel)) {
    result.push_back({voxel, {}});
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const Vec3 arm = row(branches.arm, b);
      for (const Vec3& p : images_in_reach(scene, lattice.centre(voxel), row(branches.start, b), arm))
        result.back().branches.push_back({b, mean(p, arm)});
    }
  }
  return result;
}

}  // namespace grainvdb
