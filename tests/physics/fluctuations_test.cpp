// Granular temperature and rotational fluctuation against the variance that the particles were given.
#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/mask.hpp"
#include "support/lattice_packing.hpp"
#include "support/random.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::fluctuations_test {
namespace {

constexpr double diameter = 0.8e-3;
constexpr double cutoff = 3 * diameter;
constexpr int draws = 30;

/// Grains in the flow v_x = shear_rate z, each with a fluctuation of magnitude 1 in a direction of its own, in every
/// frame another one: T₀ = 1 without the scatter of a drawn variance. Spins alike.
std::vector<Frame> fluctuating(const Frame& packing, double shear_rate) {
  Random random(4242);
  std::vector<Frame> frames;
  for (int k = 0; k < draws; ++k) {
    Frame f = packing;
    f.step = k;
    f.contacts = {};
    for (Columns3* columns : {&f.particles.velocity, &f.particles.angular_velocity})
      for (std::size_t i = 0; i < f.particles.size(); ++i) {
        const Vec3 n = random.normal3();
        const double length = std::hypot(n[0], n[1], n[2]);
        for (std::size_t a = 0; a < 3; ++a) (*columns)[a][i] = n[a] / length;
        (*columns)[0][i] += shear_rate * f.particles.position[2][i];
      }
    frames.push_back(std::move(f));
  }
  return frames;
}

/// The grains of the shear cell that comes with the repository, diameters 0.64 to 0.96 mm, wall grains included.
Frame random_packing() {
  const auto source = open_dumps(shear_cell_input());
  return source->read(0, Column::velocity | Column::angular_velocity | Column::radius | Column::mass | Column::type);
}

/// A cubic crystal of touching grains.
Frame crystal() {
  Frame f = cubic_packing(10, true, [](const Vec3&) { return Vec3{}; });
  f.box.periodic[2] = false;
  for (std::size_t a = 0; a < 3; ++a) {
    for (double& x : f.particles.position[a]) x = diameter * (x + 0.5);
    f.box.lo[a] = 0;
    f.box.hi[a] = 10 * diameter;
  }
  std::fill(f.particles.radius.begin(), f.particles.radius.end(), 0.5 * diameter);
  return f;
}

struct Case {
  const char* mode;
  const char* self_weight;
  double shear_rate;  ///< times (c²/12)^½
  double expected;    ///< of the mean over voxels at least c from both ends
  double tolerance;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.mode << " self_weight " << c.self_weight << " shear " << c.shear_rate;
}

struct Means {
  double temperature = 0, spin = 0;
};

Means measure(const Frame& packing, const Case& c) {
  Pipeline p = make_pipeline(diameter / 2, {0, 0, 0}, cutoff, {"temperature", "rotational_fluctuation"});
  for (const std::string stage : {"temperature", "rotational_fluctuation"}) {
    set_option(p, stage, "mode", std::string(c.mode));
    set_option(p, stage, "self_weight", std::string(c.self_weight));
  }
  const std::vector<Frame> frames = fluctuating(packing, c.shear_rate / (cutoff / std::sqrt(12)));
  const Result r = run(p, frames);
  const auto [low, high] =
      std::minmax_element(packing.particles.position[2].begin(), packing.particles.position[2].end());
  Means sum;
  double voxels = 0;
  const FieldCopy& t = r.only().field("temperature");
  t.for_each_active([&](const Coord& v) {
    const double z = (v.z + 0.5) * p.voxel;
    if (z < *low + cutoff || z > *high - cutoff) return;
    sum.temperature += static_cast<double>(t.at(v));
    sum.spin += static_cast<double>(r.only().field("rotational_fluctuation").at(v));
    ++voxels;
  });
  return {sum.temperature / voxels, sum.spin / voxels};
}

// What is left to chance are the products of the fluctuations of different grains: -2 δ_α·w_αβ δ_β, of variance
// 4 Σ_{β≠α} w_αβ²/3 for grain α, 4b/3 with b = 0.027, once for each of the 200 grains in the 3 diameters of height that
// are looked at and each of 30 draws: 0.2 % of T₀, and half of it about the mean at the voxel, where two fluctuations
// come with w² twice. Three times that is 0.7 %; within it, and so within 1 %, the corrected modes must meet T₀. In
// shear the mean position of the grains about a voxel is off its centre by √(S b c²/12), which adds a part b S of
// (c²/12) L:L for S < 0.1 the structure factor of a dense packing.
//
// Uncorrected, physics section 3 gives 1 - 2a + b and 1 - b at one size and without interpolation; over the sizes, and
// with a, b from the program, the values are measured, and the bounds hold them apart from T₀.
constexpr double chance = 0.007;
constexpr double uncorrected_two_pass = 0.883, uncorrected_one_pass = 0.971;
constexpr double spread = 0.015;

class Fluctuations : public ::testing::TestWithParam<Case> {};

TEST_P(Fluctuations, OfARandomPacking) {
  const Means m = measure(random_packing(), GetParam());
  EXPECT_NEAR(m.temperature, GetParam().expected, GetParam().tolerance);
  EXPECT_NEAR(m.spin, GetParam().expected, GetParam().tolerance);
}

TEST_P(Fluctuations, OfACrystal) {
  const Means m = measure(crystal(), GetParam());
  EXPECT_NEAR(m.temperature, GetParam().expected, GetParam().tolerance);
  EXPECT_NEAR(m.spin, GetParam().expected, GetParam().tolerance);
}

INSTANTIATE_TEST_SUITE_P(Modes, Fluctuations,
                         ::testing::Values(Case{"two_pass", "none", 0, uncorrected_two_pass, spread},
                                           Case{"two_pass", "corrected", 0, 1, chance},
                                           Case{"two_pass", "corrected", 1, 1, chance},
                                           Case{"one_pass", "none", 0, uncorrected_one_pass, spread},
                                           Case{"one_pass", "corrected", 0, 1, chance},
                                           Case{"one_pass_corrected", "none", 1, uncorrected_one_pass, spread},
                                           Case{"one_pass_corrected", "corrected", 1, 1, chance}));

}  // namespace
}  // namespace grainvdb::testing::fluctuations_test
