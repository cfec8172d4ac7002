#pragma once
/// Packings beside walls.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::walls_scene {

using Kernel = WallSpec::Kernel;

inline constexpr double spacing = 0.1;
inline constexpr double volume_per_grain = spacing * spacing * spacing;  // so that φ = 1 far from walls

inline double radius_of(double volume) {
  return std::cbrt(volume / (4.0 / 3 * std::numbers::pi));
}

/// Grains on a cubic lattice of this spacing, at halves of it from the planes x, y, z = 0, in [0, length); φ = 1.
inline Frame filled(const Vec3& length, std::array<bool, 3> periodic) {
  Frame f;
  f.file = "memory";
  f.box = {{0, 0, 0}, length, periodic};
  const auto n = [&](std::size_t a) { return static_cast<int>(std::lround(length[a] / spacing)); };
  std::int64_t id = 0;
  for (int i = 0; i < n(0); ++i)
    for (int j = 0; j < n(1); ++j)
      for (int k = 0; k < n(2); ++k) {
        const Vec3 x{(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing};
        add_particle(f.particles, ++id, 1, x, {x[2], 0, 0}, {0, 0, 0}, radius_of(volume_per_grain), 1);
      }
  return f;
}

inline Frame layers() {
  return filled({2, 2, 2.5}, {true, true, false});
}

inline Pipeline with_walls(Kernel kernel, double voxel, const Vec3& origin, std::vector<std::string> fields) {
  Pipeline p = make_pipeline(voxel, origin, 1, std::move(fields));
  p.walls.kernel = kernel;
  return p;
}

inline Wall floor_at(double z) {
  return {Wall::Shape::plane, {0, 0, z}, {0, 0, 1}};
}

inline std::uint32_t bit(Reason r) {
  return static_cast<std::uint32_t>(r);
}

}  // namespace grainvdb::testing::walls_scene
