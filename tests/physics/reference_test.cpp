// The brute force itself against what is known exactly: a reference that is wrong proves nothing.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/kernel_sums.hpp"
#include "support/principal.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/uncertain.hpp"

namespace grainvdb::testing::reference_test {
namespace {

TEST(Reference, KernelIntegratesToOne) {
  const Quadrature rule = gauss_legendre(12);
  double integral = 0;
  for (std::size_t g = 0; g < rule.node.size(); ++g) {
    const double r = 2.5 * rule.node[g];
    integral += rule.weight[g] * 2.5 * 4 * std::numbers::pi * r * r * lucy(r, 2.5);
  }
  EXPECT_NEAR(integral, 1, 1e-14);
}

TEST(Reference, GaussRuleIsExactForPolynomials) {
  const Quadrature rule = gauss_legendre(5);
  for (int power = 0; power <= 9; ++power) {
    double sum = 0;
    for (std::size_t g = 0; g < rule.node.size(); ++g) sum += rule.weight[g] * std::pow(rule.node[g], power);
    EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-15) << power;
  }
}

// A line through the centre: ∫₀^t (1-q)³(1+3q) dq = t - 2t³ + 2t⁴ - 3t⁵/5, q = r/c.
TEST(Reference, LineMeanThroughTheCentre) {
  const double c = 1.7;
  const auto half = [](double t) { return t - 2 * std::pow(t, 3) + 2 * std::pow(t, 4) - 0.6 * std::pow(t, 5); };
  const double k = 105 / (16 * std::numbers::pi * std::pow(c, 3));
  // From -0.3 c to 0.5 c, and out through the rim to 1.5 c.
  EXPECT_NEAR(line_mean({-0.3 * c, 0, 0}, {0.8 * c, 0, 0}, c), k * (half(0.3) + half(0.5)) / 0.8, 1e-15 * k);
  EXPECT_NEAR(line_mean({0, -0.3 * c, 0}, {0, 1.8 * c, 0}, c), k * (half(0.3) + half(1)) / 1.8, 1e-15 * k);
}

// Against the same integral by the midpoint rule with so many steps that its error, of the order of W'' (a/n)²/24 plus
// the kink at the rim, is below 1e-9 of the peak.
TEST(Reference, LineMeanAgainstManySteps) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Vec3 d;
    Vec3 a;
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = random.uniform(-0.8, 0.8);
      a[i] = random.uniform(-0.5, 0.5);
    }
    constexpr int steps = 20000;
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
      const double s = (k + 0.5) / steps;
      sum += lucy(std::sqrt(std::pow(d[0] + s * a[0], 2) + std::pow(d[1] + s * a[1], 2) + std::pow(d[2] + s * a[2], 2)),
                  1);
    }
    EXPECT_NEAR(line_mean(d, a, 1), sum / steps, 1e-9 * lucy(0, 1));
  }
}

TEST(Reference, PrincipalFrameOfAKnownTensor) {
  // Eigenvalues 3, 1, -2 about axes turned by 0.4 about z, and an antisymmetric part that must not matter.
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  UncertainTensor t;
  const double values[] = {3 * c * c + s * s, 2 * c * s + 0.7, 0, 2 * c * s - 0.7, 3 * s * s + c * c, 0, 0, 0, -2};
  for (std::size_t k = 0; k < 9; ++k) t[k] = {values[k], 0};
  const Principal p = principal_of(t);
  EXPECT_NEAR(p.values[0], 3, 1e-14);
  EXPECT_NEAR(p.values[1], 1, 1e-14);
  EXPECT_NEAR(p.values[2], -2, 1e-14);
  EXPECT_NEAR(angle_between(p.axes[0], {c, s, 0}), 0, 1e-14);
  EXPECT_NEAR(angle_between(p.axes[1], {-s, c, 0}), 0, 1e-14);
  EXPECT_NEAR(angle_between(p.axes[2], {0, 0, 1}), 0, 1e-14);
}

// What the error bounds promise, tried with random errors of the inputs.
TEST(Reference, ErrorBoundsHold) {
  Random random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto input = [&] { return Uncertain{random.uniform(0.1, 2), random.uniform(0, 0.05)}; };
    const Uncertain a = input();
    const Uncertain b = input();
    const auto off = [&](const Uncertain& x) { return x.value + random.uniform(-1, 1) * x.error; };
    const double x = off(a);
    const double y = off(b);
    const auto holds = [](const Uncertain& bound, double value) {
      return std::abs(bound.value - value) <= bound.error;
    };
    EXPECT_TRUE(holds(a * b, x * y));
    EXPECT_TRUE(holds(a / b, x / y));
    EXPECT_TRUE(holds(a - b, x - y));
    EXPECT_TRUE(holds(root(a), std::sqrt(x)));
    const auto f = static_cast<float>(x);
    EXPECT_TRUE(holds(stored({x, 0}), static_cast<double>(f)));
  }
}

// The scenes are what they are meant to be: otherwise agreement on them would say little.
TEST(Reference, ScenesReachIntoTheCorners) {
  for (const Scene& scene : {periodic_scene(), walled_scene(), dilute_scene()}) {
    std::size_t across = 0;
    std::size_t outside = 0;
    for (const Frame& f : scene.frames) {
      EXPECT_GT(f.contacts.size(), 1U) << scene.name;
      const Branches b = branches_of(f);
      for (std::size_t k = 0; k < f.contacts.size(); ++k)
        for (std::size_t a = 0; a < 3; ++a)
          if (f.box.periodic[a] &&
              std::abs(b.start[2 * k][a] - b.start[2 * k + 1][a]) > f.box.length(static_cast<int>(a)) / 2)
            ++across;
      for (std::size_t i = 0; i < f.particles.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a)
          if (f.box.periodic[a] &&
              (f.particles.position[a][i] < f.box.lo[a] || f.particles.position[a][i] >= f.box.hi[a]))
            ++outside;
    }
    EXPECT_GT(across, 0U) << scene.name;
    EXPECT_GT(outside, 0U) << scene.name;
  }
}

}  // namespace
}  // namespace grainvdb::testing::reference_test
