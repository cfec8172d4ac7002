#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::spot_drift_test {
namespace {

constexpr double pi = std::numbers::pi;

/// Compressive principal stresses 4 (at the angle psi from x), 2 (y) and 1, in the x-z plane.
std::vector<double> plane_stress(double psi) {
  const double c = std::cos(psi);
  const double s = std::sin(psi);
  return {-4 * c * c - s * s, 0, -3 * c * s, 0, -2, 0, -3 * c * s, 0, -4 * s * s - c * c};
}

/// 3³ voxels with that stress, density 2 and a mean extreme stress of slopes 0.3 and -1.5 along x and z.
FakeInput sloping(double psi) {
  FakeInput in(make_topology({0, 0, 0}, {2, 2, 2}));
  in.set("stress", plane_stress(psi));
  in.set("density", 2.0);
  in.set("velocity", std::vector<double>(3, 0.0));
  in.set("mean_extreme_stress", 1, [](const Coord& c, int) { return 10 + 0.3 * c.x - 1.5 * c.z; });
  in.set_option("spot_drift", "gravity", std::vector<double>{0, 0, -1});
  return in;
}

/// -(1 + cos 2ε [[cos 2ψ, sin 2ψ], [sin 2ψ, -cos 2ψ]]) (F_body - cos² φ ∇p), ε = π/4 - φ/2: as published, in a plane.
std::array<double, 2> published(double psi, double friction_angle) {
  const double epsilon = pi / 4 - friction_angle / 2;
  const double share = std::cos(friction_angle) * std::cos(friction_angle);
  const double fx = 0 - share * 0.3;
  const double fz = -2 - share * -1.5;
  const double c = std::cos(2 * epsilon);
  return {-(fx + c * (std::cos(2 * psi) * fx + std::sin(2 * psi) * fz)),
          -(fz + c * (std::sin(2 * psi) * fx - std::cos(2 * psi) * fz))};
}

// Slip lines are good to a few 2⁻²⁴, gradients of values near 10 to 10 · 2⁻²⁴.
constexpr double rounding = 5e-6;

TEST(SpotDrift, IsThePublishedOneInAPlane) {
  for (double psi : {0.0, 0.4, pi / 4, 1.2, pi / 2, 2.5}) {
    FakeInput given = sloping(psi);
    given.set_option("slip_lines", "friction", std::string("given"));
    given.set_option("slip_lines", "friction_angle", 0.45);
    FakeInput mobilised = sloping(psi);
    const double mobilised_angle = std::atan((4.0 - 1.0) / (2 * std::sqrt(4.0)));
    for (const auto& [in, angle] : {std::pair{&given, 0.45}, std::pair{&mobilised, mobilised_angle}}) {
      const std::vector<double> drift = in->values("spot_drift", {1, 1, 1});
      const std::array<double, 2> expected = published(psi, angle);
      EXPECT_NEAR(drift[0], expected[0], rounding) << psi;
      EXPECT_NEAR(drift[1], 0, rounding) << psi;
      EXPECT_NEAR(drift[2], expected[1], rounding) << psi;
    }
  }
}

// Where the stress gradient does not hold the weight, spots rise.
TEST(SpotDrift, RisesAgainstGravity) {
  FakeInput in = sloping(pi / 2);
  EXPECT_GT(in.value("spot_drift", {1, 1, 1}, 2), 0);
}

TEST(SpotDrift, TheMeanExtremeStressIsThatOfThePlane) {
  FakeInput in = one_voxel();
  in.set("stress", plane_stress(0.7));
  EXPECT_NEAR(in.value("mean_extreme_stress"), 2.5, 4 * 0x1p-24 * 4);
}

TEST(SpotDrift, UndefinedWithoutNeighboursOrSlipLines) {
  FakeInput alone = one_voxel();
  alone.set("stress", plane_stress(0.7));
  alone.set("density", 2.0);
  alone.set("velocity", std::vector<double>(3, 0.0));
  for (double v : alone.values("spot_drift")) EXPECT_TRUE(std::isnan(v));
  EXPECT_EQ(alone.reasons_at({}), static_cast<std::uint32_t>(Reason::no_stress_gradient));

  FakeInput tensile = sloping(0);
  tensile.set("stress", {-4, 0, 0, 0, -2, 0, 0, 0, 1});
  for (double v : tensile.values("spot_drift", {1, 1, 1})) EXPECT_TRUE(std::isnan(v));
  EXPECT_TRUE(tensile.has_reason(Reason::tensile_stress, {1, 1, 1}));
}

TEST(SpotDrift, GravityHasThreeComponents) {
  FakeInput in = one_voxel();
  const Stage& stage = *in.registry().find("spot_drift");
  EXPECT_FALSE(stage.conflict(in.settings()).has_value());
  in.set_option("spot_drift", "gravity", std::vector<double>{-9.81});
  const auto conflict = stage.conflict(in.settings());
  ASSERT_TRUE(conflict.has_value());
  EXPECT_EQ(conflict->option, "gravity");
}

}  // namespace
}  // namespace grainvdb::testing::spot_drift_test
