// The kinetic stress about the time mean from moments of one sweep: against its definition, in a linear flow, and
// against the two sweeps in a smooth one.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "grainvdb/mask.hpp"
#include "support/kernel_sums.hpp"
#include "support/lattice_packing.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::kinetic_moments_test {
namespace {

Result run_about(const std::string& reference, Pipeline p, const std::vector<Frame>& frames) {
  set_option(p, "kinetic_stress", "reference", reference);
  return run(p, frames);
}

Vec3 vector_at(const FieldCopy& f, const Coord& c) {
  return {static_cast<double>(f.at(c, 0)), static_cast<double>(f.at(c, 1)), static_cast<double>(f.at(c, 2))};
}

double spread(const std::vector<Frame>& frames) {
  double largest = 0;
  for (const Frame& f : frames)
    for (const auto& v : f.particles.velocity) {
      const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
      largest = std::max(largest, *hi - *lo);
    }
  return largest;
}

/// From a particle to a point, the shortest way: no kernel is as wide as half a box.
Vec3 shortest(const Box& box, const Particles& p, std::size_t n, const Vec3& to) {
  Vec3 d;
  for (std::size_t a = 0; a < 3; ++a) {
    d[a] = to[a] - p.position[a][n];
    const double l = box.hi[a] - box.lo[a];
    if (box.periodic[a]) d[a] -= l * std::round(d[a] / l);
  }
  return d;
}

/// The mean over the frames of -Σ m d d W at a voxel, d = v - u - L (x_α - x).
std::array<double, 9> stress_about(const Scene& scene, const VoxelBox& box, const Coord& voxel, const Vec3& u,
                                   const std::array<double, 9>& slope) {
  std::array<double, 9> stress{};
  for (const Frame& f : scene.frames) {
    const Particles m = material(f, scene.select);
    for (std::size_t n = 0; n < m.size(); ++n) {
      const Vec3 to_voxel = shortest(f.box, m, n, box.centre(voxel));
      const double w = lucy(std::hypot(to_voxel[0], to_voxel[1], to_voxel[2]), scene.cutoff);
      if (w == 0) continue;
      Vec3 d;
      for (std::size_t i = 0; i < 3; ++i) {
        d[i] = m.velocity[i][n] - u[i];
        for (std::size_t j = 0; j < 3; ++j) d[i] += slope[3 * i + j] * to_voxel[j];
      }
      for (std::size_t k = 0; k < 9; ++k)
        stress[k] -= m.mass[n] * w * d[k / 3] * d[k % 3] / static_cast<double>(scene.frames.size());
    }
  }
  return stress;
}

// -Σ m d_i d_j W with d = v - u - L (x_α - x), term by term, for the u and L that were written.
TEST(KineticStressFromMoments, EqualsItsDefinition) {
  for (const Scene& scene : {periodic_scene(), walled_scene(), dilute_scene()})
    for (const std::string weighting : {"volume", "mass"}) {
      SCOPED_TRACE(scene.name + " " + weighting);
      Pipeline p = scene.pipeline({"velocity", "velocity_gradient", "kinetic_stress", "density", "mask"});
      set_option(p, "velocity", "weighting", weighting);
      const Result r = run_about("time_mean_moments", p, scene.frames);
      const Written& w = r.only();
      const VoxelBox box(scene.frames, scene.voxel, scene.origin, scene.cutoff);
      const double velocities = spread(scene.frames);
      std::size_t checked = 0;
      std::size_t telling = 0;  // values that a wrong formula could not hit
      std::size_t undefined = 0;
      w.field("kinetic_stress").for_each_active([&](const Coord& c) {
        const auto density = static_cast<double>(w.field("density").at(c));
        if (density == 0) {
          for (int k = 0; k < 9; ++k) ASSERT_EQ(w.field("kinetic_stress").at(c, k), 0);
          return;
        }
        const Vec3 u = vector_at(w.field("velocity"), c);
        std::array<double, 9> slope;
        double steepest = 0;  // row of |L|
        for (int i = 0; i < 3; ++i) {
          double row = 0;
          for (int j = 0; j < 3; ++j) {
            const auto l = static_cast<double>(w.field("velocity_gradient").at(c, 3 * i + j));
            slope[static_cast<std::size_t>(3 * i + j)] = l;
            row += std::abs(l);
          }
          steepest = std::max(steepest, row);
        }
        const std::array<double, 9> stress = stress_about(scene, box, c, u, slope);
        // Every sum that enters is rounded relative to Σ |terms| about the mean velocity a and the middle m of the
        // leaf: in all no more than the square of |v - a| + |u - a| + |L| (|x_α - m| + |x - m|). u is stored as a
        // float.
        const double range = 2 * velocities + steepest * (scene.cutoff + 7 * scene.voxel);
        const double bound = density * range * (sum_rounding * range + 2 * 0x1p-24 * std::hypot(u[0], u[1], u[2]));
        for (int k = 0; k < 9; ++k) {
          const auto found = static_cast<double>(w.field("kinetic_stress").at(c, k));
          const double expected = stress[static_cast<std::size_t>(k)];
          if (std::isnan(found)) {
            EXPECT_NE(w.mask_at(c) & static_cast<std::uint32_t>(Reason::no_gradient), 0U);
            ++undefined;
          } else {
            EXPECT_NEAR(found, expected, bound) << k;
            ++checked;
            if (std::abs(expected) > 100 * bound) ++telling;
          }
        }
      });
      EXPECT_GT(checked, 1000U);
      EXPECT_GT(telling, checked / 4);
      EXPECT_LT(undefined, checked / 10);
    }
}

/// A cubic packing of spacing 1 with the voxel centres on its sites and half-way between them: each is a centre of
/// symmetry, so that u is exact and central differences are in a linear flow.
Pipeline symmetric_pipeline(std::vector<std::string> fields) {
  return make_pipeline(0.5, {-0.25, -0.25, -0.25}, 3, std::move(fields));
}

// u = L x: no kinetic stress, where the variance about u alone has -(c²/12) ρ L Lᵀ. Velocities around a leaf range over
// less than |L| (c + 3.5 h) with the largest sum of a row for |L|; rounding of the sums is a part of ρ times its
// square.
TEST(KineticStressFromMoments, VanishesInALinearFlow) {
  const std::array<double, 9> slope{0.3, -1.1, 0.2, 0.7, -0.5, 1.3, 0.1, -0.4, 0.2};
  const Frame frame = cubic_packing(13, false, [&](const Vec3& x) {
    Vec3 v{100, 0, -50};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) v[i] += slope[3 * i + j] * x[j];
    return v;
  });
  const Result r = run_about("time_mean_moments", symmetric_pipeline({"kinetic_stress", "density"}), {frame});
  const double range = 2.5 * (3 + 3.5 * 0.5);
  const double about_u_alone = 9.0 / 12 * (0.7 * 0.7 + 0.5 * 0.5 + 1.3 * 1.3);  // yy
  ASSERT_LT(sum_rounding * range * range, 1e-3 * about_u_alone);
  for (int i = 10; i <= 14; ++i)
    for (int j = 10; j <= 14; ++j)
      for (int k = 10; k <= 14; ++k)
        for (int n = 0; n < 9; ++n) {
          const auto density = static_cast<double>(r.only().field("density").at({i, j, k}));
          EXPECT_LE(std::abs(static_cast<double>(r.only().field("kinetic_stress").at({i, j, k}, n))),
                    sum_rounding * density * range * range);
        }
}

/// Lattice sums about a site of a cubic packing of spacing 1: those of W, and weighed by W, of cos(k z), of E and E²,
/// E = (k z)²/2 + k |z| k²/6.
struct LatticeSums {
  LatticeSums(double cutoff, double k) {
    const int reach = static_cast<int>(cutoff);
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z) {
          const double w = lucy(std::hypot(x, y, z), cutoff);
          const double e = k * k * z * z / 2 + k * std::abs(z) * k * k / 6;
          density += w;
          smoothing += w * std::cos(k * z);
          off += w * e;
          off_square += w * e * e;
        }
    for (double* sum : {&smoothing, &off, &off_square}) *sum /= density;
  }
  double density = 0, smoothing = 0, off = 0, off_square = 0;
};

// Voxels on the sites of a cubic packing, h = 1, in the flow u_x = A sin(k z), k = 2π/n. Its kernel mean λ A sin(k z)
// is exact at every site. The two sweeps take it at the particle, the moments extrapolate from the voxel with the
// central difference: the two references differ by λ A |sin k(z + r) - sin kz - r cos kz sin(k)/1| ≤ λ A E(r), by
// Taylor's theorem and k - sin k ≤ k³/6. The fluctuation of the particles is (1 - λ) A sin(k z), plus ±δ that changes
// its sign from one frame to the other, whose products with the difference average out. So the stresses differ by no
// more than ρ (2 (1-λ) A λ A ⟨E⟩ + (λ A)² ⟨E²⟩) in xx, and by nothing else.
TEST(KineticStressFromMoments, AgreesWithTwoSweepsInASmoothFlow) {
  constexpr double amplitude = 1;
  constexpr double fluctuation = 0.3;
  constexpr double cutoff = 3;
  for (const int n : {12, 24}) {
    const double k = 2 * std::numbers::pi / n;
    const auto at_sign = [&](double sign) {
      return cubic_packing(n, true, [&](const Vec3& x) {
        const bool odd = (std::lround(x[0]) + std::lround(x[1]) + std::lround(x[2])) % 2 != 0;
        const double delta = (odd ? -sign : sign) * fluctuation;
        return Vec3{amplitude * std::sin(k * x[2]) + delta, delta, 0};
      });
    };
    const std::vector<Frame> frames{at_sign(1), at_sign(-1)};
    const Pipeline p = make_pipeline(1, {-0.5, -0.5, -0.5}, cutoff, {"kinetic_stress"});
    const Result two_sweeps = run_about("time_mean", p, frames);
    const Result moments = run_about("time_mean_moments", p, frames);
    EXPECT_EQ(two_sweeps.plan.sweeps.size(), 2U);
    EXPECT_EQ(moments.plan.sweeps.size(), 1U);

    const LatticeSums sums(cutoff, k);
    const double lost = (1 - sums.smoothing) * amplitude;
    const double kept = sums.smoothing * amplitude;
    const double bound = sums.density * (2 * lost * kept * sums.off + kept * kept * sums.off_square);
    const double range = 4 * (amplitude + fluctuation) + k * amplitude * (cutoff + 7);  // as above
    const double rounding = sums.density * sum_rounding * range * range;
    double largest = 0;
    moments.only().field("kinetic_stress").for_each_active([&](const Coord& c) {
      for (int m = 0; m < 9; ++m) {
        const auto a = static_cast<double>(two_sweeps.only().field("kinetic_stress").at(c, m));
        const auto b = static_cast<double>(moments.only().field("kinetic_stress").at(c, m));
        EXPECT_NEAR(b, a, (m == 0 ? bound : 0) + rounding) << c.z << " " << m;
        if (m == 0) largest = std::max(largest, std::abs(b - a));
      }
      const auto xy = static_cast<double>(moments.only().field("kinetic_stress").at(c, 1));
      EXPECT_NEAR(xy, -sums.density * fluctuation * fluctuation, rounding);
    });
    EXPECT_GT(largest, 0.1 * bound) << n;  // the bound is no looser than that
  }
}

}  // namespace
}  // namespace grainvdb::testing::kinetic_moments_test
