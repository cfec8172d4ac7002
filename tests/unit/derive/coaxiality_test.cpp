#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::coaxiality_test {
namespace {

constexpr double pi = std::numbers::pi;
using Matrix = std::array<double, 9>;

Matrix rotated(const Matrix& a, const Matrix& r) {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) out[3 * i + j] += r[3 * i + k] * a[3 * k + l] * r[3 * j + l];
  return out;
}

/// Rotation by `angle` about a unit axis (Rodrigues).
Matrix rotation(const Vec3& n, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Matrix cross{0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  Matrix r{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r[3 * i + j] = (i == j ? c : 0) + (1 - c) * n[i] * n[j] + s * cross[3 * i + j];
  return r;
}

double angle_of(const Matrix& stress, const Matrix& gradient) {
  FakeInput in = one_voxel();
  in.set("stress", std::vector<double>(stress.begin(), stress.end()));
  in.set("velocity_gradient", std::vector<double>(gradient.begin(), gradient.end()));
  return in.value("coaxiality_angle");
}

// σ = -p 1 + 2η D, whatever the flow: coaxial. The axes are good to √3 2⁻²⁴ max|σ|/gap, with p/τ = 2.5 a few 1e-7.
TEST(Coaxiality, ZeroForANewtonianFluid) {
  FakeInput in(make_topology({0, 0, 0}, {7, 7, 7}));
  const auto l = [](const Coord& c, int k) { return noise(c, static_cast<std::uint64_t>(k)) - 0.5; };
  in.set("velocity_gradient", 9, l);
  in.set("stress", 9, [&](const Coord& c, int k) {
    const int transposed = k % 3 * 3 + k / 3;
    return 4 * (l(c, k) + l(c, transposed)) - (k % 4 == 0 ? 10 : 0);
  });
  std::size_t compared = 0;
  in.for_each([&](const Coord& c) {
    const std::vector<double> s = in.values("principal_stress", c);
    const double gap = (s[1] - s[2]) / std::abs(s[2]);
    if (gap < 1e-4) return;
    ++compared;
    // Rounding errors of both tensors turn their axes, and the gap divides them.
    EXPECT_NEAR(in.value("coaxiality_angle", c), 0, 4e-7 / gap + 1e-7);
  });
  EXPECT_GT(compared, 500U);
}

// The major axes are turned against each other about the middle axis of D, and about a random one.
TEST(Coaxiality, IsTheAngleOfAKnownTurn) {
  const Matrix strain{1, 0, 0, 0, 0.1, 0, 0, 0, -1.1};
  const Matrix stress{-1, 0, 0, 0, -2, 0, 0, 0, -4};
  const Vec3 tilt{0.6, 0, 0.8};
  const Matrix frame = rotation(tilt, 0.7);
  for (double turn : {0.0, 1e-3, 0.2, 0.7, 1.2, pi / 2, 2.0, 3.0, pi}) {
    const double folded = turn <= pi / 2 ? turn : pi - turn;
    const Matrix turned = rotated(stress, rotation({0, 1, 0}, turn));
    EXPECT_NEAR(angle_of(turned, strain), folded, 1e-6) << turn;
    EXPECT_NEAR(angle_of(rotated(turned, frame), rotated(strain, frame)), folded, 1e-6) << turn;
  }
  // A turn about the major axis itself leaves it where it is.
  EXPECT_NEAR(angle_of(rotated(stress, rotation({0, 0, 1}, 0.9)), strain), 0, 1e-6);
}

// The most compressive direction belongs to the most contractile one: with the shear stress of the wrong sign they are
// perpendicular, and a vorticity in the velocity gradient changes nothing.
TEST(Coaxiality, CompressionBelongsToContraction) {
  const Matrix shear_flow{0, 0, 5, 0, 0, 0, 0, 0, 0};
  EXPECT_NEAR(angle_of({-100, 0, 40, 0, -100, 0, 40, 0, -100}, shear_flow), 0, 1e-6);
  EXPECT_NEAR(angle_of({-100, 0, -40, 0, -100, 0, -40, 0, -100}, shear_flow), pi / 2, 1e-6);
}

TEST(Coaxiality, UndefinedWithoutAxes) {
  const auto reason_of = [](const std::vector<double>& stress, const std::vector<double>& gradient) {
    FakeInput in = one_voxel();
    in.set("stress", stress);
    in.set("velocity_gradient", gradient);
    const double angle = in.value("coaxiality_angle");
    EXPECT_EQ(std::isnan(angle), in.reasons_at({}) != 0);
    return in.reasons_at({});
  };
  const std::vector<double> stress{-100, 0, 40, 0, -100, 0, 40, 0, -100};
  const std::vector<double> isotropic{-1, 0, 0, 0, -1, 0, 0, 0, -1};
  const std::vector<double> flow{0, 0, 5, 0, 0, 0, 0, 0, 0};
  const std::vector<double> rotation_only{0, 1, 0, -1, 0, 0, 0, 0, 0};
  const std::vector<double> dilation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<double> stretched{2, 0, 0, 0, -1, 0, 0, 0, -1};  // two equal contractions
  const std::vector<double> flattened{1, 0, 0, 0, 1, 0, 0, 0, -2};   // one contraction: defined
  const auto strain = static_cast<std::uint32_t>(Reason::degenerate_strain_axes);
  const auto stress_bit = static_cast<std::uint32_t>(Reason::degenerate_stress_axes);
  EXPECT_EQ(reason_of(stress, flow), 0U);
  EXPECT_EQ(reason_of(stress, rotation_only), strain);
  EXPECT_EQ(reason_of(stress, std::vector<double>(9, 0.0)), strain);
  EXPECT_EQ(reason_of(stress, dilation), strain);
  EXPECT_EQ(reason_of(stress, stretched), strain);
  EXPECT_EQ(reason_of(stress, flattened), 0U);
  EXPECT_EQ(reason_of(isotropic, flow), stress_bit);
  EXPECT_EQ(reason_of(isotropic, dilation), strain | stress_bit);
}

TEST(Coaxiality, GapAndLeastShearRateAreOptions) {
  const auto defined = [](const char* option, double value) {
    FakeInput in = one_voxel();
    in.set("stress", {-100, 0, 40, 0, -100, 0, 40, 0, -100});
    in.set("velocity_gradient", {1, 0, 0, 0, -0.5, 0, 0, 0, -0.7});  // |γ̇| = 1.31, gap 0.2
    in.set_option("coaxiality_angle", option, value);
    const bool d = std::isfinite(in.value("coaxiality_angle"));
    EXPECT_EQ(in.has_reason(Reason::degenerate_strain_axes), !d);
    return d;
  };
  EXPECT_TRUE(defined("gap", 0.19));
  EXPECT_FALSE(defined("gap", 0.21));
  EXPECT_TRUE(defined("shear_rate_min", 1.0));
  EXPECT_FALSE(defined("shear_rate_min", 2.0));
}

}  // namespace
}  // namespace grainvdb::testing::coaxiality_test
