// Gradients and temperatures where methods bias them or have little to stand on.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/mask.hpp"
#include "stability/regimes.hpp"
#include "support/kernel_sums.hpp"
#include "support/lattice_packing.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"

namespace grainvdb::testing::flow_test {
namespace {

// The kernel's own derivative at the edges of a plug: the two sums of the quotient rule cancel to rounding of double,
// 2⁻⁵² of |u| |∇W|/W, which is |u|/h at most 10⁴ at the outermost voxels. Never u/2h.
TEST(PlugFlow, HasNoGradientByTheKernelEither) {
  const Vec3 u{2, -0.5, 0.25};
  const Scene scene = in_plug_flow(walled_scene(), u);
  Pipeline p = make_pipeline(scene.voxel, scene.origin, scene.cutoff, {"velocity_gradient", "mask"});
  p.select = scene.select;
  set_option(p, "velocity_gradient", "method", std::string("kernel"));
  const Result r = run(p, scene.frames);
  const FieldCopy& l = r.only().field("velocity_gradient");
  std::size_t values = 0;
  l.for_each_active([&](const Coord& c) {
    for (int k = 0; k < 9; ++k) {
      if (std::isnan(l.at(c, k))) continue;
      ++values;
      EXPECT_LE(std::abs(static_cast<double>(l.at(c, k))), 1e-11 * 2 / scene.voxel);
    }
  });
  EXPECT_GT(values, 10000U);
}

// u = γ z in a packing that is periodic along x and y. About the mean over planes T has nothing of its own but the
// ripple of the lattice: the mean offset of the sites is at most 2.9e-3 c (see LinearFlow of the flow identities).
TEST(ShearFlow, HasNoTemperatureAboutItsProfile) {
  const double rate = 0.7;
  Frame f = cubic_packing(13, false, [&](const Vec3& x) { return Vec3{rate * x[2], 0, 0}; });
  f.box.periodic = {true, true, false};
  Pipeline p = make_pipeline(0.5, {-0.5, -0.5, -0.25}, 3, {"temperature"});
  set_option(p, "temperature", "mode", std::string("two_pass_profile"));
  const Result r = run(p, {f});
  for (int k = 10; k <= 14; ++k)
    EXPECT_LE(static_cast<double>(r.only().field("temperature").at({7, 4, k})), std::pow(rate * 2.9e-3 * 3, 2));
}

/// ∫ φ T dV of one moving grain among resting ones, over its V v²: what a mode leaves of independent fluctuations.
double left_of_one(const std::string& mode) {
  const Frame f = cubic_packing(8, true, [](const Vec3& x) {
    return x == Vec3{4, 4, 4} ? Vec3{1, 0, 0} : Vec3{0, 0, 0};
  });
  Pipeline p = make_pipeline(0.5, {-0.25, -0.25, -0.25}, 3, {"phi", "temperature"});
  set_option(p, "temperature", "mode", mode);
  const Result r = run(p, {f});
  const FieldCopy& phi = r.only().field("phi");
  const FieldCopy& t = r.only().field("temperature");
  double sum = 0;
  phi.for_each_active([&](const Coord& v) { sum += static_cast<double>(phi.at(v)) * static_cast<double>(t.at(v)); });
  return sum * 0.125 / (std::numbers::pi / 6);
}

// The other modes' share of their own weight, as two_pass has it in the flow identities. one_pass: the variance about
// the mean at the voxel lacks the square of the mean, 1 - b, b = (V/φ) 455/(176πc³) with V/φ = 1; tolerances as there.
TEST(SelfWeight, OfTheOnePassTemperature) {
  const double b = 455 / (176 * std::numbers::pi * 27);
  EXPECT_NEAR(left_of_one("one_pass"), 1 - b, b * 0.006);
}

// Profile: 64 grains share each plane, so that 1 - 2a + b with the marginal in place of W: a = w₁(0)/64, and b is the
// sum of the squares over the eight layers.
TEST(SelfWeight, OfTheProfileTemperature) {
  const auto marginal = [](double z) {
    const double q = std::abs(z) / 3;
    return q < 1 ? 21.0 / 48 * std::pow(1 - q, 4) * (1 + 4 * q + 5 * q * q) : 0;
  };
  double sum = 0;
  double squares = 0;
  for (int k = -3; k <= 3; ++k) {
    sum += marginal(k);
    squares += marginal(k) * marginal(k);
  }
  // Only the moving grain's own fluctuation weighs twice; the others see u = w₁/64 of it each, 64 in a layer.
  const double expected = 1 - 2 * marginal(0) / sum / 64 + squares / (sum * sum) / 64;
  EXPECT_NEAR(left_of_one("two_pass_profile"), expected, 1e-4);
  EXPECT_GT(expected, 0.985);
}

// A wave u = sin kz in a periodic packing, k = 2π/12: the kernel smooths it by Ŵ(kc) (physics section 2, 1 - (kc)²/24
// for long waves), and central differences of it are low by sin(kh)/(kh) = 1 - (kh)²/6. The sites sample the wave, and
// alias it to the waves 2πn ± k. The projection on the wave itself, at voxels of h = ½, confuses 4π ± k with k:
// Ŵ(4πc) = 630 (1 + 15/38)/38⁵ = 1.1e-5 for each, times the ratio of the wave numbers, 24, in the derivative.
TEST(Wave, IsSmoothedAndDifferentiatedAsDerived) {
  const double k = 2 * std::numbers::pi / 12;
  const double c = 3;
  const double h = 0.5;
  const Frame f = cubic_packing(12, true, [&](const Vec3& x) { return Vec3{std::sin(k * x[2]), 0, 0}; });
  const auto amplitude = [&](const std::string& method, const std::string& field, int component, double phase) {
    Pipeline p = make_pipeline(h, {-0.25, -0.25, -0.25}, c, {field});
    set_option(p, "velocity_gradient", "method", method);
    const Result r = run(p, {f});
    double sum = 0;
    for (int n = -1; n < 23; ++n)  // z = n h over the period
      sum += static_cast<double>(r.only().field(field).at({5, 8, n}, component)) * std::sin(k * n * h + phase) / 12;
    return sum;
  };
  const double q = k * c;
  const double smoothed = 630 * (q * q * std::sin(q) + q * (7 * std::cos(q) + 8) - 15 * std::sin(q)) / std::pow(q, 7);
  const double u = amplitude("central", "velocity", 0, 0);
  EXPECT_NEAR(u, smoothed, 2.2e-5);
  EXPECT_NEAR(1 - u, q * q / 24, 0.1 * q * q / 24);
  const double central = amplitude("central", "velocity_gradient", 2, std::numbers::pi / 2);
  EXPECT_NEAR(central / (k * u), std::sin(k * h) / (k * h), 1e-6);
  EXPECT_NEAR(1 - central / (k * u), k * k * h * h / 6, 0.05 * k * k * h * h / 6);
  const double kernel = amplitude("kernel", "velocity_gradient", 2, std::numbers::pi / 2);
  EXPECT_NEAR(kernel / (k * u), 1, 2 * 24 * 1.1e-5 / smoothed + 5e-5);
}

}  // namespace
}  // namespace grainvdb::testing::flow_test
