#include "unit/splat/scene.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace grainvdb {

Lattice Scene::lattice() const {
  Lattice lattice(voxel, origin);
  lattice.set_periods(box);
  return lattice;
}

Vec3 Scene::shortest(const Vec3& a, const Vec3& b) const {
  Vec3 d{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  for (int axis = 0; axis < 3; ++axis) {
    auto& x = d[static_cast<std::size_t>(axis)];
    if (!box.periodic[static_cast<std::size_t>(axis)]) continue;
    const double l = box.length(axis);
    while (x > l / 2) x -= l;
    while (x < -l / 2) x += l;
  }
  return d;
}

std::vector<Coord> Scene::voxels(double margin) const {
  const Lattice l = lattice();
  std::array<std::int32_t, 3> first{}, last{};
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    if (const auto& period = l.period(a)) {
      first[k] = period->first;
      last[k] = period->first + period->count - 1;
    } else {
      first[k] = static_cast<std::int32_t>(std::floor(l.to_index(a, box.lo[k] - margin)));
      last[k] = static_cast<std::int32_t>(std::ceil(l.to_index(a, box.hi[k] + margin)));
    }
  }
  std::vector<Coord> all;
  for (std::int32_t x = first[0]; x <= last[0]; ++x)
    for (std::int32_t y = first[1]; y <= last[1]; ++y)
      for (std::int32_t z = first[2]; z <= last[2]; ++z) all.push_back({x, y, z});
  return all;
}

Columns3 Scene::random_positions(std::size_t n, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  const Lattice l = lattice();
  Columns3 x;
  for (std::size_t k = 0; k < n; ++k)
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      double position = box.lo[axis] + box.length(a) * uniform(random);
      const int kind = static_cast<int>(12 * uniform(random));
      if (kind == 0) position = box.lo[axis];
      if (kind == 1) position = box.hi[axis];
      if (kind == 2) position = box.hi[axis] + 0.01 * voxel;
      if (kind == 3) position = l.centre(a, static_cast<std::int32_t>(std::round(l.to_index(a, position))));
      if (kind == 4 && box.periodic[axis]) position += 3 * box.length(a);
      if (kind == 5 && box.periodic[axis]) position -= 2 * box.length(a);
      x[axis].push_back(position);
    }
  return x;
}

std::ostream& operator<<(std::ostream& out, const Scene& scene) {
  return out << scene.name;
}

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all{
      {"periodic", {{-3, -2, 1}, {3.5, 3, 6}, {true, true, true}}, 0.5, {0, 0, 0}, 1.6},
      {"mixed", {{-2, 0, -4}, {2, 3, 1}, {true, false, true}}, 0.25, {0.06, 0.9, -17.3}, 0.8},
      {"slab", {{0, 0, 0}, {6, 5, 7}, {true, true, false}}, 1, {0.4, -0.3, 0.2}, 2.1},
      {"open", {{-3, -3, -3}, {2, 1, 2}, {false, false, false}}, 0.5, {0.1, 0.2, 0.3}, 1.25},
      {"fine", {{-1, -1, -1}, {1, 1, 1}, {true, true, true}}, 0.1, {-0.03, 0, 0.02}, 0.6},
      {"wide", {{0, 0, 0}, {2.25, 2.25, 2.25}, {true, true, true}}, 0.125, {0, 0.05, 0}, 1.0875}};
  return all;
}

std::vector<double> random_values(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> q(n);
  for (double& x : q) x = uniform(random);
  return q;
}

Vec3 row(const Columns3& columns, std::size_t k) {
  return {columns[0][k], columns[1][k], columns[2][k]};
}

double norm(const Vec3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double value_at(const LeafBuffers& buffers, const Coord& c, int channel) {
  const auto leaf = buffers.topology()->find(leaf_origin(c));
  return leaf ? buffers.block(*leaf, channel)[leaf_offset(c)] : 0;
}

bool is_active(const Topology& topology, const Coord& c) {
  const auto leaf = topology.find(leaf_origin(c));
  return leaf && topology.mask(*leaf).test(leaf_offset(c));
}

void expect_zero_where_inactive(const LeafBuffers& buffers) {
  std::size_t wrong = 0;
  for (std::size_t l = 0; l < buffers.topology()->leaf_count(); ++l)
    for (int c = 0; c < buffers.channels(); ++c)
      for (int o = 0; o < leaf_size; ++o)
        wrong += !buffers.topology()->mask(l).test(o) && buffers.block(l, c)[o] != 0 ? 1U : 0U;
  EXPECT_EQ(wrong, 0u);
}

void expect_same_bytes_for_any_threads(const std::function<LeafBuffers()>& f) {
  const auto with_threads = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return f();
  };
  const LeafBuffers one = with_threads(1);
  ASSERT_GT(one.topology()->leaf_count(), 2u);
  for (int repeat = 0; repeat < 3; ++repeat) {
    const LeafBuffers two = with_threads(2);
    ASSERT_EQ(one.topology()->origins(), two.topology()->origins());
    ASSERT_EQ(one.bytes(), two.bytes());
    for (std::size_t l = 0; l < one.topology()->leaf_count(); ++l) {
      EXPECT_EQ(one.topology()->mask(l), two.topology()->mask(l));
      for (int c = 0; c < one.channels(); ++c)
        EXPECT_EQ(std::memcmp(one.block(l, c), two.block(l, c), leaf_size * sizeof(double)), 0);
    }
  }
}

double lucy(double r, double c) {
  const double q = r / c;
  return q < 1 ? lucy_peak(c) * (1 - q) * (1 - q) * (1 - q) * (1 + 3 * q) : 0;
}

double lucy_peak(double c) {
  return 105 / (16 * std::numbers::pi * c * c * c);
}
double largest_gradient(double c) {
  return 3.714 / (c * c * c * c);
}
double largest_curvature(double c) {
  return 1260 / (16 * std::numbers::pi * c * c * c * c * c);
}

double position_error(const Columns3& position) {
  double largest = 0;
  for (const auto& column : position)
    for (const double x : column) largest = std::max(largest, std::abs(x));
  return 16 * std::numeric_limits<double>::epsilon() * (largest + 20);
}

}  // namespace grainvdb
