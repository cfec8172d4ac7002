#pragma once
/// Crystals of grains in boxes.
#include <cmath>
#include <initializer_list>
#include <vector>

#include "grainvdb/frame.hpp"
#include "support/random.hpp"

namespace grainvdb::testing {

/// Grains at places of a box.
struct Scene {
  Box box;
  Columns3 position;
  std::vector<double> radius;

  std::size_t size() const { return radius.size(); }
  void add(const Vec3& x, double r) {
    for (std::size_t a = 0; a < 3; ++a) position[a].push_back(x[a]);
    radius.push_back(r);
  }
  Frame frame() const {
    Frame f;
    f.file = "scene.dump";
    f.box = box;
    f.particles.position = position;
    f.particles.radius = radius;
    for (std::size_t i = 0; i < size(); ++i) f.particles.id.push_back(static_cast<std::int64_t>(i) + 1);
    return f;
  }
};

/// n³ cubic cells of an edge, with a basis in parts of the edge, periodic; grains of diameter 1 [length].
inline Scene crystal(int n, double edge, std::initializer_list<Vec3> basis) {
  Scene s;
  // Away from the lower faces of the box, so that rounding puts no grain on the other side of it.
  const double lo = -0.123 * edge;
  s.box = {{lo, lo, lo}, {lo + n * edge, lo + n * edge, lo + n * edge}, {true, true, true}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (const Vec3& b : basis) s.add({(i + b[0]) * edge, (j + b[1]) * edge, (k + b[2]) * edge}, 0.5);
  return s;
}

/// Touching spheres of diameter 1: simple, face-centred and body-centred cubic.
inline Scene simple_cubic(int n) {
  return crystal(n, 1, {{0, 0, 0}});
}
inline Scene face_centred(int n) {
  return crystal(n, std::sqrt(2.0), {{0, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}});
}
inline Scene body_centred(int n) {
  return crystal(n, 2 / std::sqrt(3.0), {{0, 0, 0}, {0.5, 0.5, 0.5}});
}

/// A layer of touching spheres of diameter 1 at the places of a hexagonal lattice, one diameter high between open
/// faces.
inline Scene hexagonal_layer(int n) {
  Scene s;
  const double row = std::sqrt(0.75);
  s.box = {{-0.1, -0.1, 0}, {n - 0.1, 2 * n * row - 0.1, 1}, {true, true, false}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      s.add({static_cast<double>(i), 2 * j * row, 0.5}, 0.5);
      s.add({i + 0.5, (2 * j + 1) * row, 0.5}, 0.5);
    }
  return s;
}

/// Grains of diameter 1 at independent, uniformly distributed places.
inline Scene poisson(const Box& box, std::size_t n, std::uint64_t seed) {
  Scene s;
  s.box = box;
  Random random(seed);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = random.uniform(box.lo[a], box.hi[a]);
    s.add(x, 0.5);
  }
  return s;
}

}  // namespace grainvdb::testing
