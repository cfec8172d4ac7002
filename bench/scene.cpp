#include "scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace grainvdb::bench {
namespace {

/// Uniform in [-1, 1): the distributions of the standard library differ between implementations.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : bits_(seed) {}
  double operator()() { return static_cast<double>(bits_() >> 11) * 0x1p-52 - 1; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits_() % n); }

 private:
  std::mt19937_64 bits_;
};

struct Pair {
  std::uint32_t a, b;
  double gap;
};

/// All pairs whose surfaces are less than 0.4 apart, nearest first.
std::vector<Pair> near_pairs(const Scene& scene) {
  constexpr double reach = 1.2 + 0.4;
  const auto edge = static_cast<std::size_t>(scene.edge / reach) + 1;
  const auto cell_of = [&](int axis, std::size_t i) {
    const double cell = std::clamp(scene.position[static_cast<std::size_t>(axis)][i] / reach, 0.0, edge - 1.0);
    return static_cast<std::size_t>(cell);
  };
  std::vector<std::vector<std::uint32_t>> cells(edge * edge * edge);
  for (std::size_t i = 0; i < scene.size(); ++i)
    cells[(cell_of(0, i) * edge + cell_of(1, i)) * edge + cell_of(2, i)].push_back(static_cast<std::uint32_t>(i));

  std::vector<Pair> pairs;
  const auto around = [&](std::size_t c) { return std::pair{c == 0 ? c : c - 1, std::min(c + 1, edge - 1)}; };
  for (std::uint32_t i = 0; i < scene.size(); ++i) {
    const auto [x0, x1] = around(cell_of(0, i));
    const auto [y0, y1] = around(cell_of(1, i));
    const auto [z0, z1] = around(cell_of(2, i));
    for (std::size_t x = x0; x <= x1; ++x)
      for (std::size_t y = y0; y <= y1; ++y)
        for (std::size_t z = z0; z <= z1; ++z)
          for (const std::uint32_t j : cells[(x * edge + y) * edge + z]) {
            if (j <= i) continue;
            double r2 = 0;
            for (const auto& p : scene.position) r2 += (p[i] - p[j]) * (p[i] - p[j]);
            const double gap = std::sqrt(r2) - 0.5 * (scene.diameter[i] + scene.diameter[j]);
            if (gap < 0.4) pairs.push_back({i, j, gap});
          }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return p.gap != q.gap ? p.gap < q.gap : p.a != q.a ? p.a < q.a : p.b < q.b;
  });
  return pairs;
}

}  // namespace

Scene make_scene(std::size_t particles) {
  constexpr double fraction = 0.6;
  constexpr double spread = 0.2;
  constexpr double jitter = 0.08;
  // ⟨d³⟩ = 1 + spread² for d uniform in 1 ± spread
  const double volume = std::numbers::pi / 6 * (1 + spread * spread);
  const double cell = std::cbrt(4 * volume / fraction);
  const auto cells = std::max(1L, std::lround(std::cbrt(static_cast<double>(particles) / 4)));
  constexpr std::array<std::array<double, 3>, 4> basis{{{0, 0, 0}, {0, .5, .5}, {.5, 0, .5}, {.5, .5, 0}}};

  Uniform random(1);
  std::vector<std::array<double, 3>> sites;
  for (long i = 0; i < cells; ++i)
    for (long j = 0; j < cells; ++j)
      for (long k = 0; k < cells; ++k)
        for (const auto& b : basis) {
          const std::array<double, 3> corner{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          auto& site = sites.emplace_back();
          for (std::size_t a = 0; a < 3; ++a) site[a] = (corner[a] + b[a] + 0.25) * cell + jitter * random();
        }
  for (std::size_t i = sites.size(); i > 1; --i) std::swap(sites[i - 1], sites[random.below(i)]);

  Scene scene;
  scene.edge = static_cast<double>(cells) * cell;
  scene.diameter.reserve(sites.size());
  for (const auto& site : sites) {
    for (std::size_t a = 0; a < 3; ++a) {
      scene.position[a].push_back(site[a]);
      scene.velocity[a].push_back(0.17 * random() + (a == 0 ? 0.05 * site[2] : 0.0));
      scene.spin[a].push_back(1.7 * random());
    }
    scene.diameter.push_back(1 + spread * random());
  }
  return scene;
}

std::vector<double> moments(const Scene& scene, int channels) {
  const auto width = static_cast<std::size_t>(channels);
  std::vector<double> q(scene.size() * width);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const double d = scene.diameter[i];
    const double v = std::numbers::pi / 6 * d * d * d;
    const double x = scene.velocity[0][i], y = scene.velocity[1][i], z = scene.velocity[2][i];
    const std::array<double, all_channels> all{v,
                                               v * x,
                                               v * y,
                                               v * z,
                                               v * d,
                                               v * scene.spin[0][i],
                                               v * scene.spin[1][i],
                                               v * scene.spin[2][i],
                                               v * x * x,
                                               v * y * y,
                                               v * z * z,
                                               v * x * y,
                                               v * x * z,
                                               v * y * z};
    std::copy_n(all.begin(), width, q.begin() + static_cast<std::ptrdiff_t>(i * width));
  }
  return q;
}

Branches make_branches(const Scene& scene) {
  std::vector<Pair> pairs = near_pairs(scene);
  pairs.resize(std::min(pairs.size(), 3 * scene.size()));
  // Dumps list contacts by their particles.
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& p, const Pair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });

  Uniform random(2);
  Branches branches;
  const auto add = [&](std::uint32_t from, std::uint32_t to, const std::array<double, 3>& force) {
    const double part = scene.diameter[from] / (scene.diameter[from] + scene.diameter[to]);
    branches.particle.push_back(from);
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = scene.position[a][from];
      branches.start[a].push_back(x);
      branches.arm[a].push_back((x - scene.position[a][to]) * part);
      branches.force[a].push_back(force[a]);
    }
  };
  for (const Pair& p : pairs) {
    const std::array<double, 3> force{random(), random(), random()};
    add(p.a, p.b, force);
    add(p.b, p.a, {-force[0], -force[1], -force[2]});
  }
  return branches;
}

std::vector<double> stress_values(const HalfBranches& branches) {
  std::vector<double> q;
  q.reserve(9 * branches.size());
  for (std::size_t b = 0; b < branches.size(); ++b)
    for (const auto& force : branches.force)
      for (const auto& arm : branches.arm) q.push_back(-force[b] * arm[b]);
  return q;
}

}  // namespace grainvdb::bench
