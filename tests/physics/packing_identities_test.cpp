// What is known exactly of the packing fraction and of fields that are weighted by it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/lattice_packing.hpp"
#include "support/random.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::packing_identities_test {
namespace {

constexpr double unit_sphere = std::numbers::pi / 6;  // volume of a sphere of diameter 1

double sum_of(const FieldCopy& f) {
  double sum = 0;
  f.for_each_active([&](const Coord& c) { sum += static_cast<double>(f.at(c)); });
  return sum;
}

/// |h³ Σ φ/V - 1| for one particle that lies `offset` (in voxels) from a voxel centre.
double volume_error(double cutoff_in_voxels, const Vec3& offset) {
  const double h = 1 / cutoff_in_voxels;
  Pipeline p = make_pipeline(h, {-0.5 * h, -0.5 * h, -0.5 * h}, 1, {"phi"});
  p.limits.volume_error = 2;
  const Result r = run(p, {one_particle({offset[0] * h, offset[1] * h, offset[2] * h})});
  return std::abs(h * h * h * sum_of(r.only().field("phi")) / unit_sphere - 1);
}

// Physics section 7: max |h³ΣW - 1| over offsets. The extremes lie at points of symmetry, which the quarters of a voxel
// contain; the figures are given to two to four digits.
TEST(PackingIdentities, VolumeOfOneParticle) {
  const std::vector<std::pair<double, double>> known{{1, 1.089},    {1.25, .244}, {1.5, .0369}, {2, .0157},
                                                     {2.5, 6.0e-4}, {3, 2.2e-3},  {4, 3.3e-4},  {6, 2.4e-5}};
  for (const auto& [ratio, expected] : known) {
    double worst = 0;
    for (double x : {0.0, 0.25, 0.5})
      for (double y : {0.0, 0.25, 0.5})
        for (double z : {0.0, 0.25, 0.5})
          if (x <= y && y <= z) worst = std::max(worst, volume_error(ratio, {x, y, z}));
    EXPECT_NEAR(worst / expected, 1, 0.03) << "c/h = " << ratio;
  }
}

// h³Σφ = ΣV: each particle's own error is at most 2.4e-5 at c/h = 6.
TEST(PackingIdentities, VolumeOfManyParticles) {
  Scene scene = walled_scene();
  scene.voxel = 0.25;
  scene.cutoff = 6 * 0.25;
  Pipeline p = scene.pipeline({"phi", "density"});
  p.frames.stop = 1;
  const Result r = run(p, scene.frames);
  double volume = 0;
  double mass = 0;
  const Particles& all = scene.frames[0].particles;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.type[i] != 1) continue;
    volume += 4.0 / 3 * std::numbers::pi * std::pow(all.radius[i], 3);
    mass += all.mass[i];
  }
  const double cell = std::pow(scene.voxel, 3);
  EXPECT_NEAR(cell * sum_of(r.only().field("phi")) / volume, 1, 2.5e-5);
  EXPECT_NEAR(cell * sum_of(r.only().field("density")) / mass, 1, 2.5e-5);
}

// Physics section 6: ripple of φ on a cubic lattice. Voxel centres at multiples of d/4 meet sites, edges, faces and
// body centres, where the extremes are. Tolerance: half a unit of the last digit given.
TEST(PackingIdentities, RippleOfACubicLattice) {
  struct Known {
    double cutoff, lowest, highest, digit;
  };
  for (const Known& k : {Known{3, -0.062, 0.22, 0.006}, Known{2, -1.57, 1.45, 0.006}, Known{1.5, -1.17, 3.69, 0.006},
                         Known{1, -85.5, 108.9, 0.06}}) {
    const Result r = run(make_pipeline(0.25, {-0.125, -0.125, -0.125}, k.cutoff, {"phi"}),
                         {cubic_packing(6, true, [](const Vec3&) { return Vec3{}; })});
    const FieldCopy& phi = r.only().field("phi");
    double lowest = 1e9;
    double highest = -1e9;
    phi.for_each_active([&](const Coord& c) {
      const double ripple = 100 * (static_cast<double>(phi.at(c)) / unit_sphere - 1);
      lowest = std::min(lowest, ripple);
      highest = std::max(highest, ripple);
    });
    EXPECT_NEAR(lowest, k.lowest, k.digit) << "c = " << k.cutoff << " d";
    EXPECT_NEAR(highest, k.highest, k.digit) << "c = " << k.cutoff << " d";
  }
}

// Physics section 6: the part of a kernel inside a wall. Voxel faces lie on the wall, so that the sum over the voxels
// inside is the midpoint rule for the marginal w₁: error ≤ (h²/24) max|w₁'| with |w₁'| ≤ 2.2/c², h = c/24: 1.6e-4, plus
// half a unit of the last digit.
TEST(PackingIdentities, KernelCutByAWall) {
  struct Known {
    double distance, fraction, digit;
  };
  for (const Known& k : {Known{0, .5, 0}, Known{.1, .629, 5e-4}, Known{.25, .797, 5e-4}, Known{.5, .9585, 5e-5},
                         Known{.75, .9981, 5e-5}}) {
    const double h = 1.0 / 24;
    const Result r = run(make_pipeline(h, {0, 0, 0}, 1, {"phi"}), {one_particle({0.3, 0.2, k.distance})});
    const FieldCopy& phi = r.only().field("phi");
    double inside = 0;
    phi.for_each_active([&](const Coord& c) {
      if (c.z >= 0) inside += static_cast<double>(phi.at(c));
    });
    EXPECT_NEAR(inside * h * h * h / unit_sphere, k.fraction, 1.6e-4 + k.digit) << "at " << k.distance << " c";
  }
}

// Physics section 7: φ/φ₀ at distances outside the surface of a packing that fills a half-space, here layers at
// (k + ½) s below it. Their sum is the midpoint rule for ∫ w₁ from z on, which is off by (s²/24) w₁'(z) with
// w₁' = -(210/16) ζ (1+3ζ) (1-ζ)³ (c = 1); the next term is of the order of s⁴/1000.
TEST(PackingIdentities, FreeSurface) {
  Frame f;
  f.file = "memory";
  f.box = {{0, 0, -2}, {2.2, 2.2, 2}, {true, true, false}};
  const double spacing = 0.1;
  std::int64_t id = 0;
  for (int i = 0; i < 22; ++i)
    for (int j = 0; j < 22; ++j)
      for (int k = 0; k < 20; ++k)
        add_particle(f.particles, ++id, 1, {(i + 0.5) * spacing, (j + 0.5) * spacing, -(k + 0.5) * spacing}, {0, 0, 0},
                     {0, 0, 0}, 0.05, 1);
  const double phi_0 = 4.0 / 3 * std::numbers::pi * std::pow(0.05, 3) / std::pow(spacing, 3);
  for (const auto& [z, fraction] : {std::pair{0.0, 0.5}, {0.379, 0.1}, {0.640, 0.01}, {0.781, 1e-3}}) {
    const double h = 0.2;
    const Result r = run(make_pipeline(h, {0, 0, z - h / 2}, 1, {"phi"}), {f});
    const double layers = -spacing * spacing / 24 * 210.0 / 16 * z * (1 + 3 * z) * std::pow(1 - z, 3);
    // Half a unit of the last digit of z, times the slope w₁(z).
    const double digit = 5e-4 * 21.0 / 16 * std::pow(1 - z, 4) * (1 + 4 * z + 5 * z * z);
    EXPECT_NEAR(static_cast<double>(r.only().field("phi").at({3, 3, 0})) / phi_0, fraction + layers, digit + 1e-6)
        << "z = " << z;
  }
}

// Physics section 6: ∫ φ d dV/∫ φ dV = Σ V d/Σ V = ⟨d⁴⟩/⟨d³⟩, 1.038769 of the mean for sizes uniform in 0.8 … 1.2.
// 400 sizes at the middles of equal shares are the distribution to 1e-6; h³Σ is good to 2.4e-5 at c/h = 6.
TEST(PackingIdentities, MeanDiameterOfAPolydispersePacking) {
  Random random(12);
  Frame f;
  f.file = "memory";
  f.box = {{0, 0, 0}, {8, 8, 8}, {true, true, true}};
  for (int i = 0; i < 400; ++i)
    add_particle(f.particles, i + 1, 1, {random.uniform(0, 8), random.uniform(0, 8), random.uniform(0, 8)}, {0, 0, 0},
                 {0, 0, 0}, 0.5 * (0.8 + 0.4 * (i + 0.5) / 400), 1);
  const Result r = run(make_pipeline(0.5, {0.1, 0.2, 0.3}, 3, {"phi", "mean_diameter"}), {f});
  const FieldCopy& phi = r.only().field("phi");
  const FieldCopy& d = r.only().field("mean_diameter");
  double numerator = 0;
  phi.for_each_active(
      [&](const Coord& c) { numerator += static_cast<double>(phi.at(c)) * static_cast<double>(d.at(c)); });
  EXPECT_NEAR(numerator / sum_of(phi), 1.038769, 5e-5);
}

}  // namespace
}  // namespace grainvdb::testing::packing_identities_test
