// What is known exactly of velocities and their fluctuations.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/mask.hpp"
#include "support/lattice_packing.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::flow_identities_test {
namespace {

const std::vector<std::string> modes{"two_pass", "two_pass_profile", "one_pass", "one_pass_corrected"};

void set_mode(Pipeline& p, const std::string& mode) {
  set_option(p, "temperature", "mode", mode);
  if (mode != "one_pass_corrected") set_option(p, "rotational_fluctuation", "mode", mode);
}

bool has(std::uint32_t bits, Reason r) {
  return (bits & static_cast<std::uint32_t>(r)) != 0;
}

/// All particles of the scene with one velocity and one spin.
Scene translated(Scene scene, const Vec3& velocity) {
  for (Frame& f : scene.frames)
    for (std::size_t a = 0; a < 3; ++a) {
      std::fill(f.particles.velocity[a].begin(), f.particles.velocity[a].end(), velocity[a]);
      std::fill(f.particles.angular_velocity[a].begin(), f.particles.angular_velocity[a].end(), velocity[a]);
    }
  return scene;
}

// Rigid translation: T = 0, δω² = 0 for equal spins, kinetic stress 0, u exact. A mean of equal velocities, formed in
// double from N ≤ 200 terms and interpolated, is off by at most N 2⁻⁵² |v| = 5e-14 |v| (a random walk of roundings
// stays far below): T of the two-pass modes is the square of that. The difference of second moments is off by that
// times |v|². In one_pass_corrected, T is not defined where the subtracted part, from u rounded to float, exceeds the
// variance.
TEST(FlowIdentities, Translation) {
  const Vec3 v{3.7, -1.3, 0.9};
  const double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  constexpr double mean_error = 5e-14;
  for (const Scene& scene : {translated(periodic_scene(), v), translated(walled_scene(), v)})
    for (const std::string& mode : modes) {
      SCOPED_TRACE(scene.name + " " + mode);
      Pipeline p = scene.pipeline({"velocity", "temperature", "angular_velocity", "rotational_fluctuation",
                                   "kinetic_stress", "velocity_gradient", "density", "mask"});
      set_mode(p, mode);
      const Result r = run(p, scene.frames);
      const Written& w = r.only();
      const double bound = mode.starts_with("two_pass") ? v2 * mean_error * mean_error : v2 * 2 * mean_error;
      std::size_t voxels = 0;
      w.field("velocity").for_each_active([&](const Coord& c) {
        if (has(w.mask_at(c), Reason::no_material)) return;
        ++voxels;
        const auto t = static_cast<double>(w.field("temperature").at(c));
        if (mode == "one_pass_corrected" && has(w.mask_at(c), Reason::negative_temperature)) {
          EXPECT_TRUE(std::isnan(t));
        } else if (!has(w.mask_at(c), Reason::no_gradient) || mode != "one_pass_corrected") {
          EXPECT_LE(t, bound);
        }
        EXPECT_LE(w.field("rotational_fluctuation").at(c), static_cast<float>(v2 * 2 * mean_error));
        for (int i = 0; i < 3; ++i) {
          const double vi = v[static_cast<std::size_t>(i)];
          EXPECT_NEAR(static_cast<double>(w.field("velocity").at(c, i)), vi, std::abs(vi) * 0x1p-23);
          EXPECT_NEAR(static_cast<double>(w.field("angular_velocity").at(c, i)), vi, std::abs(vi) * 0x1p-23);
        }
        const auto density = static_cast<double>(w.field("density").at(c));
        for (int k = 0; k < 9; ++k)
          EXPECT_LE(std::abs(static_cast<double>(w.field("kinetic_stress").at(c, k))),
                    density * v2 * mean_error * mean_error);
      });
      EXPECT_GT(voxels, 500U);
    }
}

// Plug flow has no gradient, at the rim of the material as inside: sums of powers of two times a weight divide by the
// sum of the weights exactly, so the differences of u are exactly 0, one-sided or not.
TEST(FlowIdentities, PlugFlowHasNoGradient) {
  const Scene scene = translated(walled_scene(), {2, -0.5, 0.25});
  const Result r = run(scene.pipeline({"velocity_gradient", "shear_rate", "mask"}), scene.frames);
  const Written& w = r.only();
  std::size_t one_sided = 0;
  w.field("shear_rate").for_each_active([&](const Coord& c) {
    if (has(w.mask_at(c), Reason::one_sided_gradient)) ++one_sided;
    for (int k = 0; k < 9; ++k) {
      const float l = w.field("velocity_gradient").at(c, k);
      EXPECT_TRUE(l == 0 || std::isnan(l)) << l;
    }
  });
  EXPECT_GT(one_sided, 100U);
}

/// Fields of a cubic packing of 9³ particles of diameter 1 in the flow u = L x, c = 3, at the voxel in its middle and
/// those up to one diameter around it: all kernels there are full.
struct LinearFlow {
  explicit LinearFlow(const std::array<double, 9>& gradient, const std::string& mode)
      : frame(cubic_packing(13, false, [&](const Vec3& x) {
          Vec3 v{};
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) v[i] += gradient[3 * i + j] * x[j];
          return v;
        })) {
    Pipeline p = make_pipeline(0.5, {-0.25, -0.25, -0.25}, cutoff, {"temperature", "velocity_gradient", "shear_rate"});
    set_option(p, "temperature", "mode", mode);
    result = run(p, {frame});
  }
  template <class F>
  void inside(F&& f) const {
    for (int i = 10; i <= 14; ++i)
      for (int j = 10; j <= 14; ++j)
        for (int k = 10; k <= 14; ++k) f(Coord{i, j, k});
  }
  static constexpr double cutoff = 3;
  Frame frame;
  Result result;
};

double squares(const std::array<double, 9>& l) {
  double sum = 0;
  for (double x : l) sum += x * x;
  return sum;
}

// By Poisson summation a sum over lattice sites differs from the integral by the kernel's transform at the reciprocal
// vectors. At |k| = 2π c/d = 18.8 Ŵ'' ≤ 630 (k² + 15 k)/k⁷ = 4.8e-4 (in units of c²), and six of them count: 2.9e-3 c²
// of T against c²/12 L:L, 3.5 %. The mean offset of the sites, Ŵ' at the same vectors, is as small: 2.9e-3 c L.
constexpr double variance_ripple = 0.035;
constexpr double offset_ripple = 2.9e-3;
// Central differences reach over 2 h = d, one period of the lattice, over which u grows by exactly L d: only the
// errors of u ≤ 17 are left, twice: 2⁻²⁴ of it from the float grid, and those of its two sums.
constexpr double gradient_rounding = 2 * 17 * (0x1p-24 + 2 * sum_rounding);

// u = L x (physics section 6): one_pass has T = (c²/12) L:L of its own, one_pass_corrected none, two_pass only the
// square of the ripple of u.
TEST(FlowIdentities, LinearFlow) {
  const std::array<double, 9> l{0.1, 0.7, -0.3, 0.2, -0.4, 0.5, 0.6, -0.1, 0.3};
  const double spurious = LinearFlow::cutoff * LinearFlow::cutoff / 12 * squares(l);

  const LinearFlow one_pass(l, "one_pass");
  one_pass.inside([&](const Coord& c) {
    const Written& w = one_pass.result.only();
    EXPECT_NEAR(static_cast<double>(w.field("temperature").at(c)) / spurious, 1, variance_ripple);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(static_cast<double>(w.field("velocity_gradient").at(c, k)), l[static_cast<std::size_t>(k)],
                  gradient_rounding);
  });

  const LinearFlow corrected(l, "one_pass_corrected");
  std::size_t defined = 0;
  corrected.inside([&](const Coord& c) {
    const float t = corrected.result.only().field("temperature").at(c);
    if (std::isnan(t)) return;  // the ripple is negative here
    ++defined;
    EXPECT_LE(static_cast<double>(t), spurious * 2 * variance_ripple);
  });
  EXPECT_GT(defined, 0U);

  const LinearFlow two_pass(l, "two_pass");
  two_pass.inside([&](const Coord& c) {
    EXPECT_LE(static_cast<double>(two_pass.result.only().field("temperature").at(c)),
              squares(l) * std::pow(offset_ripple * LinearFlow::cutoff, 2));
  });
}

// Rigid rotation: |γ̇| = 0 and one_pass T = Ω² c²/6.
TEST(FlowIdentities, RigidRotation) {
  const double omega = 1.3;
  const LinearFlow flow({0, -omega, 0, omega, 0, 0, 0, 0, 0}, "one_pass");
  flow.inside([&](const Coord& c) {
    const Written& w = flow.result.only();
    const double expected = omega * omega * LinearFlow::cutoff * LinearFlow::cutoff / 6;
    EXPECT_NEAR(static_cast<double>(w.field("temperature").at(c)) / expected, 1, variance_ripple);
    EXPECT_LE(static_cast<double>(w.field("shear_rate").at(c)), 4 * gradient_rounding);
  });
}

// The self-weight of the two-pass temperature (physics section 3) without statistics: velocities that are independent
// of each other add up in squares, so one moving particle among resting ones shows it. Σ V |v_α - ũ(x_α)|² over all
// particles is V v² (1 - 2 W₀V/φ + ∫ (W V/φ)² φ/V) = V v² (1 - 2a + b). Voxel centres lie on the sites, so that nothing
// is interpolated. The integral of W² differs from the sum over sites by the ripple of φ, 0.2 %, of each W: 0.5 % of b.
TEST(FlowIdentities, SelfWeightOfTheTwoPassTemperature) {
  const double c = 3;
  const int n = 8;
  const Frame f = cubic_packing(n, true, [](const Vec3& x) {
    return x == Vec3{4, 4, 4} ? Vec3{1, 0, 0} : Vec3{0, 0, 0};
  });
  const Result r = run(make_pipeline(0.5, {-0.25, -0.25, -0.25}, c, {"phi", "temperature"}), {f});
  const FieldCopy& phi = r.only().field("phi");
  const FieldCopy& t = r.only().field("temperature");
  double sum = 0;
  phi.for_each_active([&](const Coord& v) { sum += static_cast<double>(phi.at(v)) * static_cast<double>(t.at(v)); });
  const double volume = std::numbers::pi / 6;
  const double a = 105.0 / 96 / std::pow(c, 3) / volume;  // φ = π/6 as well
  const double b = 455 / (176 * std::numbers::pi * std::pow(c, 3));
  EXPECT_NEAR(sum * 0.125 / volume, 1 - 2 * a + b, 2 * a * 0.003 + b * 0.006);
}

// A static packing has no temperature and does not flow: gd/δv is 0/0 and says so.
TEST(FlowIdentities, StaticPackingHasNoRatioOfRates) {
  const Scene scene = translated(walled_scene(), {0, 0, 0});
  const Result r =
      run(scene.pipeline({"temperature", "shear_rate", "mu", "fluidity", "gd_over_dv", "mask"}), scene.frames);
  const Written& w = r.only();
  std::size_t flowing = 0;
  std::size_t masked = 0;
  w.field("mu").for_each_active([&](const Coord& c) {
    if (has(w.mask_at(c), Reason::no_material)) return;
    EXPECT_EQ(w.field("temperature").at(c), 0.0F);
    if (w.field("fluidity").at(c) == 0.0F) ++flowing;
    EXPECT_TRUE(std::isnan(w.field("gd_over_dv").at(c)));
    if (has(w.mask_at(c), Reason::no_fluctuation)) ++masked;
  });
  EXPECT_GT(flowing, 0U);
  EXPECT_EQ(masked, flowing);
}

// Free fall: grains without contacts have no pressure but that of their fluctuations; with a floor for the pressure
// above it nothing is divided by noise.
TEST(FlowIdentities, FreeFallHasNoStressRatio) {
  Scene scene = walled_scene();
  for (Frame& f : scene.frames) f.contacts = {};
  Pipeline p = scene.pipeline({"pressure", "mu", "inertial_number", "fluidity", "mask"});
  set_option(p, "pressure", "pressure_min", 1e3);
  const Result r = run(p, scene.frames);
  const Written& w = r.only();
  w.field("mu").for_each_active([&](const Coord& c) {
    EXPECT_GE(w.field("pressure").at(c), 0.0F);
    for (const char* name : {"mu", "inertial_number", "fluidity"}) EXPECT_TRUE(std::isnan(w.field(name).at(c))) << name;
    EXPECT_TRUE(has(w.mask_at(c), Reason::low_pressure));
  });
}

}  // namespace
}  // namespace grainvdb::testing::flow_identities_test
