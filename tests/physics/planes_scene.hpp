#pragma once
/// Runs whose fields are exact averages over planes, and the sums over planes by their definition.
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"
#include "support/voxel_box.hpp"

namespace grainvdb::testing::planes_test {

/// What a sum in single precision may err by, relative to Σ |terms|.
inline constexpr double e = 1e-5;

inline double area_of(const Box& box, int axis) {
  return box.length((axis + 1) % 3) * box.length((axis + 2) % 3);
}

inline Result run_on_planes(Pipeline p, int axis, const std::vector<Frame>& frames) {
  p.planes = Planes{axis, area_of(frames[0].box, axis)};
  return run(p, frames);
}

/// The voxel of a plane, of a column that has one voxel along the planes.
inline Coord in_column(int axis, int plane) {
  return shifted({0, 0, 0}, axis, plane);
}

/// The plane run of every voxel of the column.
template <class F>
std::size_t for_each_plane(const FieldCopy& f, int axis, const F& body) {
  std::size_t planes = 0;
  f.for_each_active([&](const Coord& c) {
    EXPECT_EQ(c, in_column(axis, c[axis]));
    body(c);
    ++planes;
  });
  return planes;
}

/// Sums over the planes by their definition: Σ q w₁(z - z_α)/A over grains and their images.
class BruteForce {
 public:
  BruteForce(const Scene& scene, int axis) : scene_(scene), axis_(axis), kernel_(scene.cutoff) {}

  double centre(const Coord& c) const {
    return scene_.origin[static_cast<std::size_t>(axis_)] + (c[axis_] + 0.5) * scene_.voxel;
  }
  /// f(z) of every image, z from there to the plane.
  double over_images(const Box& box, double start, double z, const std::function<double(double)>& f) const {
    if (!box.periodic[static_cast<std::size_t>(axis_)]) return f(z - start);
    double sum = 0;
    const double length = box.length(axis_);
    const double d = (z - start) - length * std::round((z - start) / length);
    for (int k = -2; k <= 2; ++k) sum += f(d + k * length);
    return sum;
  }
  double sum(const Frame& frame, const Particles& p, double z, const std::function<double(std::size_t)>& q) const {
    double sum = 0;
    for (std::size_t n = 0; n < p.size(); ++n)
      sum += q(n) * over_images(frame.box, p.position[static_cast<std::size_t>(axis_)][n], z,
                                [&](double d) { return kernel_.marginal(d); });
    return sum / area_of(frame.box, axis_);
  }
  const LucyKernel& kernel() const { return kernel_; }

 private:
  const Scene& scene_;
  int axis_;
  LucyKernel kernel_;
};

inline Lattice lattice_of(const Scene& scene) {
  Lattice lattice(scene.voxel, scene.origin);
  lattice.set_periods(scene.frames[0].box);
  return lattice;
}

}  // namespace grainvdb::testing::planes_test
