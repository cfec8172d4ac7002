#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"
#include "unit/derive/jacobi.hpp"

namespace grainvdb::testing::principal_test {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> diagonal(double x, double y, double z) {
  return {x, 0, 0, 0, y, 0, 0, 0, z};
}

double dot(const std::vector<double>& axes, std::size_t i, std::size_t j) {
  return axes[3 * i] * axes[3 * j] + axes[3 * i + 1] * axes[3 * j + 1] + axes[3 * i + 2] * axes[3 * j + 2];
}

TEST(Principal, AscendingCompressionWithTheAxesInTheSameOrder) {
  FakeInput in = one_voxel();
  in.set("stress", diagonal(-2, -7, 1));
  EXPECT_EQ(in.values("principal_stress"), (std::vector<double>{1, -2, -7}));
  EXPECT_EQ(in.values("principal_axes"), (std::vector<double>{0, 0, 1, 1, 0, 0, 0, 1, 0}));
  EXPECT_NEAR(in.value("principal_gap"), 3.0 / 7, 0x1p-24);
}

TEST(Principal, OfSimpleShearAtFortyFiveDegrees) {
  FakeInput in = one_voxel();
  in.set("stress", {-100, 0, 40, 0, -100, 0, 40, 0, -100});
  const std::vector<double> s = in.values("principal_stress");
  EXPECT_NEAR(s[0], -60, 1e-5);
  EXPECT_NEAR(s[1], -100, 1e-5);
  EXPECT_NEAR(s[2], -140, 1e-5);
  const double r = std::sqrt(0.5);
  const std::vector<double> axes = in.values("principal_axes");
  const std::vector<double> expected{r, 0, r, 0, 1, 0, r, 0, -r};  // compressed along (1,0,-1)
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(axes[k], expected[k], 1e-7);
}

// Random, not symmetric stresses against an independent solver; σ a = s a; orthonormal; the sign convention.
TEST(Principal, AgreesWithJacobiRotations) {
  FakeInput in(make_topology({0, 0, 0}, {11, 11, 11}));
  in.set("stress", 9, [](const Coord& c, int k) {
    return 300 * (noise(c, static_cast<std::uint64_t>(k)) - 0.5) - (k % 4 == 0 ? 200 : 0);
  });
  in.derive("principal_stress");
  in.derive("principal_axes");
  std::size_t compared = 0;
  in.for_each([&](const Coord& c) {
    std::array<double, 9> stress{};
    for (std::size_t k = 0; k < 9; ++k) stress[k] = in.value("stress", c, static_cast<int>(k));
    const Eigen3 reference = jacobi(stress);
    const std::vector<double> s = in.values("principal_stress", c);
    const double scale = std::max(std::abs(reference.values[0]), std::abs(reference.values[2]));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(s[k], reference.values[k], 0x1p-24 * scale + 1e-12);
    const std::vector<double> axes = in.values("principal_axes", c);
    const double gap =
        std::min(reference.values[0] - reference.values[1], reference.values[1] - reference.values[2]) / scale;
    if (gap < 1e-4) return;
    ++compared;
    for (std::size_t i = 0; i < 3; ++i) {
      double along = 0;
      for (std::size_t j = 0; j < 3; ++j) along += axes[3 * i + j] * reference.vectors[i][j];
      // Axes agree up to sign: rounding of three components to float.
      EXPECT_NEAR(std::abs(along), 1, 2e-7);
      EXPECT_NEAR(dot(axes, i, i), 1, 2e-7);
      EXPECT_NEAR(dot(axes, i, (i + 1) % 3), 0, 2e-7);
      std::size_t first = 0;
      while (std::abs(axes[3 * i + first]) <= 0.5) ++first;
      EXPECT_GT(axes[3 * i + first], 0);
    }
  });
  EXPECT_GT(compared, 1700U);
}

// Where one gap closes, the axis that stands apart is still an axis.
TEST(Principal, AxesAreUndefinedWhereTheGapCloses) {
  const auto axes_of = [](const std::vector<double>& stress) {
    FakeInput in = one_voxel();
    in.set("stress", stress);
    std::vector<bool> defined;
    for (int k = 0; k < 3; ++k) {
      const bool d = std::isfinite(in.value("principal_axes", {}, 3 * k));
      for (int i = 1; i < 3; ++i) EXPECT_EQ(std::isfinite(in.value("principal_axes", {}, 3 * k + i)), d);
      defined.push_back(d);
    }
    EXPECT_EQ(in.has_reason(Reason::degenerate_stress_axes), !(defined[0] && defined[1] && defined[2]));
    for (double s : in.values("principal_stress")) EXPECT_TRUE(std::isfinite(s));
    return defined;
  };
  using Rows = std::vector<bool>;
  EXPECT_EQ(axes_of(diagonal(-1, -2, -3)), (Rows{true, true, true}));
  EXPECT_EQ(axes_of(diagonal(-1, -1, -3)), (Rows{false, false, true}));   // compressed along one axis
  EXPECT_EQ(axes_of(diagonal(-1, -3, -3)), (Rows{true, false, false}));   // along two
  EXPECT_EQ(axes_of(diagonal(-2, -2, -2)), (Rows{false, false, false}));  // isotropic
  EXPECT_EQ(axes_of(diagonal(0, 0, 0)), (Rows{false, false, false}));
  // The default gap is 1e-5 of the largest.
  EXPECT_EQ(axes_of(diagonal(-1, -2, -2.00001)), (Rows{true, false, false}));
  EXPECT_EQ(axes_of(diagonal(-1, -2, -2.00004)), (Rows{true, true, true}));
}

TEST(Principal, TheGapIsAnOptionAndAField) {
  FakeInput in = one_voxel();
  in.set("stress", diagonal(-1, -2, -2.5));
  EXPECT_NEAR(in.value("principal_gap"), 0.2, 0x1p-24);
  in.set_option("principal_axes", "gap", 0.3);
  EXPECT_TRUE(std::isnan(in.value("principal_axes", {}, 8)));
  EXPECT_EQ(in.value("principal_axes", {}, 0), 1);

  FakeInput zero = one_voxel();
  zero.set("stress", diagonal(0, 0, 0));
  EXPECT_TRUE(std::isnan(zero.value("principal_gap")));
  EXPECT_TRUE(zero.has_reason(Reason::degenerate_stress_axes));
  FakeInput isotropic = one_voxel();
  isotropic.set("stress", diagonal(-3, -3, -3));
  EXPECT_EQ(isotropic.value("principal_gap"), 0);
}

TEST(SlipLines, AtTheGivenAngleFromTheMostCompressiveAxis) {
  FakeInput in = one_voxel();
  in.set("stress", diagonal(-1, -2, -4));  // least compressive x, most compressive z
  in.set_option("slip_lines", "friction", std::string("given"));
  in.set_option("slip_lines", "friction_angle", pi / 6);
  const std::vector<double> lines = in.values("slip_lines");
  const std::vector<double> expected{0.5, 0, std::sqrt(0.75), -0.5, 0, std::sqrt(0.75)};  // ±30° = ±(45° - 15°)
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(lines[k], expected[k], 1e-7);
}

// What slip lines are: on the planes that contain them (and the intermediate axis) the ratio of shear to normal stress
// is the largest of all planes, μ_MC.
TEST(SlipLines, CarryTheLargestRatioOfShearToNormalStress) {
  FakeInput in(make_topology({0, 0, 0}, {3, 3, 3}));
  in.set("stress", 9, [](const Coord& c, int k) {
    const int t = k % 3 * 3 + k / 3;  // symmetric
    return 100 * (noise(c, static_cast<std::uint64_t>(std::min(k, t))) - 0.5) - (k % 4 == 0 ? 200 : 0);
  });
  in.set("density", 0.0);
  in.set("velocity", std::vector<double>(3, 0.0));
  in.derive("slip_lines");
  in.for_each([&](const Coord& c) {
    const std::vector<double> lines = in.values("slip_lines", c);
    const std::vector<double> axes = in.values("principal_axes", c);
    const std::vector<double> stress = in.values("stress", c);
    const double mu = in.value("mu_mohr_coulomb", c);
    const auto ratio = [&](const Vec3& line) {
      const Vec3 m{axes[3], axes[4], axes[5]};
      const Vec3 n{line[1] * m[2] - line[2] * m[1], line[2] * m[0] - line[0] * m[2], line[0] * m[1] - line[1] * m[0]};
      double normal = 0;
      double shear = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          normal -= n[i] * stress[3 * i + j] * n[j];
          shear += line[i] * stress[3 * i + j] * n[j];
        }
      return std::abs(shear) / normal;
    };
    for (std::size_t l = 0; l < 2; ++l) {
      const Vec3 line{lines[3 * l], lines[3 * l + 1], lines[3 * l + 2]};
      // Float rounding of axes and lines, 1e-7 each, times stresses of up to twice the normal stress.
      EXPECT_NEAR(ratio(line), mu, 2e-6);
      for (double turn : {-0.05, 0.05}) {
        Vec3 other{};
        const Vec3 m{axes[3], axes[4], axes[5]};
        const Vec3 n{line[1] * m[2] - line[2] * m[1], line[2] * m[0] - line[0] * m[2], line[0] * m[1] - line[1] * m[0]};
        for (std::size_t i = 0; i < 3; ++i) other[i] = std::cos(turn) * line[i] + std::sin(turn) * n[i];
        EXPECT_LT(ratio(other), mu);
      }
    }
  });
}

TEST(SlipLines, NeedNoMohrCoulombRatioWithAGivenAngle) {
  FakeInput in = one_voxel();
  const Stage& stage = *in.registry().find("slip_lines");
  using Names = std::vector<std::string>;
  EXPECT_EQ(stage.needs(in.settings()).fields, (Names{"principal_axes", "mu_mohr_coulomb"}));
  in.set_option("slip_lines", "friction", std::string("given"));
  EXPECT_EQ(stage.needs(in.settings()).fields, Names{"principal_axes"});
}

}  // namespace
}  // namespace grainvdb::testing::principal_test
