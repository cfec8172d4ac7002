#include "measure/affine_fit.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "measure/box_grid.hpp"
#include "support/random.hpp"

namespace grainvdb::testing::affine_fit_test {
namespace {

constexpr Vec3 box{2.5, 8, 2.5};

Vec3 anywhere(Random& random) {
  return {random.uniform(-1.25, 1.25), random.uniform(-4, 4), random.uniform(-1.25, 1.25)};
}

Vec3 affine(const std::array<double, 9>& m, const Vec3& v0, const Vec3& x) {
  Vec3 v = v0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) v[i] += m[3 * i + j] * x[j];
  return v;
}

AffineFit fit_of(const std::array<double, 9>& m, const Vec3& v0, std::size_t particles) {
  Random random(7);
  AffineFit fit;
  for (std::size_t n = 0; n < particles; ++n) {
    const Vec3 x = anywhere(random);
    fit.add(x, affine(m, v0, x));
  }
  return fit;
}

// Rounding of sums of 60 products of numbers up to 4 · 2, over their spread: 1e-13 is generous.
TEST(AffineFit, ExactForShearRotationAndAnyOther) {
  const std::array<double, 9> shear{0, 0, 2, 0, 0, 0, 0, 0, 0};
  const std::array<double, 9> rotation{0, -1, 0.5, 1, 0, 0.25, -0.5, -0.25, 0};
  const std::array<double, 9> any{1, -2, 3, 0.5, -0.25, 4, -1.5, 2, 0.75};
  for (const auto& m : {shear, rotation, any}) {
    const AffineVelocity found = fit_of(m, {3, -1, 2}, 60).fit();
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(found.gradient[k], m[k], 1e-13) << k;
    for (double e : found.error) EXPECT_LT(e, 1e-6);  // the root of what rounding leaves of the residuals
  }
  const AffineVelocity turning = fit_of(rotation, {3, -1, 2}, 60).fit();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(turning.gradient[3 * i + j] + turning.gradient[3 * j + i], 0, 1e-13);
}

// The mean velocity is taken off before sums are formed: what is left is its own rounding, 2⁻⁵³ of 1e6.
TEST(AffineFit, KeepsItsDigitsInFastFlow) {
  const std::array<double, 9> m{0, 0, 1e-3, 0, 0, 0, 0, 0, 0};
  const AffineVelocity found = fit_of(m, {1e6, 0, 0}, 60).fit();
  EXPECT_NEAR(found.gradient[2], 1e-3, 1e-9);
  EXPECT_NEAR(found.mean[0], 1e6, 1);
}

// Over many fits the deviations from the truth, in units of their errors, have the mean square (n-4)/(n-6) of Student's
// t with n - 4 degrees of freedom; of 9 × 400 of them it is known to about 3 %.
TEST(AffineFit, ErrorsAreThoseOfTheScatter) {
  const std::array<double, 9> m{1, -2, 3, 0.5, -0.25, 4, -1.5, 2, 0.75};
  constexpr int fits = 400, particles = 30;
  Random random(11);
  double squares = 0;
  for (int f = 0; f < fits; ++f) {
    AffineFit fit;
    for (int n = 0; n < particles; ++n) {
      const Vec3 x = anywhere(random);
      Vec3 v = affine(m, {}, x);
      const Vec3 noise = random.normal3();
      for (std::size_t i = 0; i < 3; ++i) v[i] += 0.3 * noise[i];
      fit.add(x, v);
    }
    const AffineVelocity found = fit.fit();
    for (std::size_t k = 0; k < 9; ++k) squares += std::pow((found.gradient[k] - m[k]) / found.error[k], 2);
  }
  constexpr double student = (particles - 4.0) / (particles - 6.0);
  EXPECT_NEAR(squares / (9 * fits), student, 0.12 * student);
}

// |γ̇| of simple shear is M_xz, and so is its error but for the share of M_zx: √(e_xz² + e_zx²), e_zx = 0 here.
TEST(AffineFit, ShearRateHasTheErrorOfItsComponents) {
  AffineVelocity velocity;
  velocity.gradient = {0, 0, 2, 0, 0, 0, 0, 0, 0};
  velocity.error = {0, 0, 0.1, 0, 0, 0, 0, 0, 0};
  EXPECT_NEAR(shear_rate_error(velocity), 0.1, 1e-15);
  velocity.error[6] = 0.1;
  EXPECT_NEAR(shear_rate_error(velocity), 0.1 * std::sqrt(2), 1e-15);
}

TEST(AffineFit, ConditionTellsPlanesAndLines) {
  EXPECT_LT(fit_of({}, {}, 500).condition(box), 1.5);  // even in all directions
  Random random(3);
  AffineFit plane;
  AffineFit thin;
  AffineFit few;
  for (int n = 0; n < 100; ++n) {
    Vec3 x = anywhere(random);
    if (n < 3) few.add(x, {});
    plane.add({x[0], x[1], x[0] - x[1] / 2}, {});
    x[2] /= 50;
    thin.add(x, {});
  }
  EXPECT_EQ(plane.condition(box), std::numeric_limits<double>::infinity());
  EXPECT_EQ(few.condition(box), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(thin.condition(box), 50, 15);  // as much as 100 places in a box are uneven
}

TEST(BoxGrid, FillsPeriodsAndBeginsAtTheOrigin) {
  const Box periodic_depth{{-10, 0, -5}, {10, 8.4, 40}, {false, true, false}};
  const BoxGrid grid({2.5, 8, 2.5}, periodic_depth, {0.5, 0.5, 0.5});
  EXPECT_EQ(grid.edge(), (Vec3{2.5, 8.4, 2.5}));
  EXPECT_EQ(grid.index({0.6, 3, 0.6}), (BoxIndex{0, 0, 0}));
  EXPECT_EQ(grid.index({0.4, 3, 3.1}), (BoxIndex{-1, 0, 1}));
  EXPECT_EQ(grid.index({0.6, -1, 0.6}), (BoxIndex{0, 0, 0}));
  EXPECT_EQ(grid.centre({-1, 0, 1}), (Vec3{-0.75, 4.2, 4.25}));
  const Vec3 offset = grid.offset({0.6, -1, 0.6});  // the image at 7.4
  EXPECT_NEAR(offset[0], -1.15, 1e-14);
  EXPECT_NEAR(offset[1], 3.2, 1e-14);
  EXPECT_NEAR(offset[2], -1.15, 1e-14);
  const BoxGrid halves({2, 4, 2}, periodic_depth, {});
  EXPECT_EQ(halves.edge()[1], 4.2);
  EXPECT_THROW(BoxGrid({0, 1, 1}, periodic_depth, {}), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::testing::affine_fit_test
