#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::gradients_test {
namespace {

/// A lattice of voxel size h with `n` voxels in a period along every axis, the first of them `first`.
Lattice periodic_lattice(double h, std::int32_t first, std::int32_t n) {
  Lattice lattice(h, {0, 0, 0});
  const double lo = first * h;
  const double hi = (first + n) * h;
  lattice.set_periods({{lo, lo, lo}, {hi, hi, hi}, {true, true, true}});
  return lattice;
}

Coord step(Coord c, int axis, int by) {
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) += by;
  return c;
}

/// 60 % of the voxels, at random: all kinds of edges, holes and isolated voxels, in leaves of both signs.
bool ragged(const Coord& c) {
  return noise(c, 7) < 0.6;
}

constexpr std::array<double, 9> dyadic_gradient{0.125, -1.5, 0.75, 2.25, 0.5, -0.875, 1.0, 0.25, -2.0};

double dyadic_flow(const Lattice& lattice, const Coord& c, int i) {
  double u = 3.5 - i;
  for (int j = 0; j < 3; ++j) u += dyadic_gradient[static_cast<std::size_t>(3 * i + j)] * lattice.centre(j, c[j]);
  return u;
}

// All numbers are short binary fractions, so float holds the velocities exactly and the differences must be exact too.
TEST(CentralDifference, LinearFlowIsExactAtEveryVoxelOfARaggedRegion) {
  const Lattice lattice(0.5, {0, 0, 0});
  const auto topology = make_topology({-9, -9, -9}, {12, 12, 12}, ragged);
  FakeInput in(topology, lattice);
  in.set("velocity", 3, [&](const Coord& c, int i) { return dyadic_flow(lattice, c, i); });
  const SparseField& g = in.derive("velocity_gradient");
  std::size_t one_sided = 0;
  std::size_t none = 0;
  in.for_each([&](const Coord& c) {
    bool any_one_sided = false;
    bool any_none = false;
    for (int j = 0; j < 3; ++j) {
      const auto inside = [&](const Coord& q) {
        for (int a = 0; a < 3; ++a)
          if (q[a] < -9 || q[a] > 12) return false;
        return ragged(q);
      };
      const int sides = (inside(step(c, j, -1)) ? 1 : 0) + (inside(step(c, j, 1)) ? 1 : 0);
      any_one_sided |= sides == 1;
      any_none |= sides == 0;
      for (int i = 0; i < 3; ++i) {
        const float v = g.value(c, 3 * i + j);
        if (sides == 0) {
          EXPECT_TRUE(std::isnan(v));
        } else {
          EXPECT_EQ(static_cast<double>(v), dyadic_gradient[static_cast<std::size_t>(3 * i + j)]);
        }
      }
    }
    EXPECT_EQ(in.has_reason(Reason::one_sided_gradient, c), any_one_sided);
    EXPECT_EQ(in.has_reason(Reason::no_gradient, c), any_none);
    one_sided += any_one_sided ? 1U : 0U;
    none += any_none ? 1U : 0U;
  });
  EXPECT_EQ(in.mask().count(Reason::one_sided_gradient), one_sided);
  EXPECT_EQ(in.mask().count(Reason::no_gradient), none);
  EXPECT_GT(one_sided, 1000U);  // the region was ragged enough to mean something
  EXPECT_GT(none, 1000U);
}

TEST(CentralDifference, PlugFlowIsExactlyZeroAtRaggedEdges) {
  FakeInput in(make_topology({-9, -9, -9}, {12, 12, 12}, ragged), Lattice(0.3, {0.1, 0.2, 0.3}));
  constexpr std::array<double, 3> u{0.1, -123.456, 7e-5};
  in.set("velocity", 3, [&](const Coord& c, int i) {
    return noise(c, 8) < 0.1 ? static_cast<double>(nan) : u[static_cast<std::size_t>(i)];
  });
  const SparseField& g = in.derive("velocity_gradient");
  std::size_t zeros = 0;
  in.for_each([&](const Coord& c) {
    for (int k = 0; k < 9; ++k) {
      const float v = g.value(c, k);
      if (std::isnan(v)) continue;
      EXPECT_EQ(v, 0.0F);
      ++zeros;
    }
  });
  EXPECT_GT(zeros, 20000U);
}

// Per voxel: the value, and what a neighbour that is active but undefined does.
TEST(CentralDifference, OneSidedFormulas) {
  const Lattice lattice(0.5, {0, 0, 0});
  // Voxels 0 … 4 along x; voxel 2 has no velocity, so 0-1 and 3-4 are pairs with first-order differences.
  FakeInput pairs(make_topology({0, 0, 0}, {4, 0, 0}), lattice);
  const auto square = [&](const Coord& c, int i) {
    const double x = lattice.centre(0, c.x);
    return i == 0 ? x * x : 0.0;
  };
  pairs.set("velocity", 3,
            [&](const Coord& c, int i) { return c.x == 2 && i == 1 ? static_cast<double>(nan) : square(c, i); });
  const auto first_order = [&](std::int32_t a, std::int32_t b) { return lattice.centre(0, a) + lattice.centre(0, b); };
  EXPECT_EQ(pairs.value("velocity_gradient", {0, 0, 0}), first_order(0, 1));
  EXPECT_EQ(pairs.value("velocity_gradient", {1, 0, 0}), first_order(0, 1));
  EXPECT_EQ(pairs.value("velocity_gradient", {3, 0, 0}), first_order(3, 4));
  for (int k = 0; k < 9; ++k) EXPECT_TRUE(std::isnan(pairs.value("velocity_gradient", {2, 0, 0}, k)));
  EXPECT_EQ(pairs.reasons_at({2, 0, 0}), 0U);  // whoever left the velocity undefined has said why
  EXPECT_TRUE(pairs.has_reason(Reason::one_sided_gradient, {1, 0, 0}));

  // Three in a row: the three-point formula is exact for a parabola at both ends.
  FakeInput three(make_topology({0, 0, 0}, {2, 0, 0}), lattice);
  three.set("velocity", 3, square);
  for (std::int32_t x = 0; x < 3; ++x) {
    EXPECT_EQ(three.value("velocity_gradient", {x, 0, 0}), 2 * lattice.centre(0, x));
    EXPECT_EQ(three.has_reason(Reason::one_sided_gradient, {x, 0, 0}), x != 1);
  }
}

TEST(CentralDifference, IsolatedVoxelHasNone) {
  FakeInput in = one_voxel();
  in.set("velocity", {1.0, 2.0, 3.0});
  for (double v : in.values("velocity_gradient")) EXPECT_TRUE(std::isnan(v));
  EXPECT_TRUE(std::isnan(in.value("shear_rate")));
  EXPECT_EQ(in.reasons_at({}), static_cast<std::uint32_t>(Reason::no_gradient));
}

TEST(CentralDifference, AColumnHasDerivativesAlongItselfOnly) {
  FakeInput in(make_topology({0, 0, 0}, {0, 0, 4}));
  in.set("velocity", 3, [](const Coord& c, int i) { return (i + 1.0) * c.z; });
  const std::vector<double> g = in.values("velocity_gradient", {0, 0, 2});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(g[3 * i]));
    EXPECT_TRUE(std::isnan(g[3 * i + 1]));
    EXPECT_EQ(g[3 * i + 2], static_cast<double>(i) + 1);
  }
  EXPECT_TRUE(in.has_reason(Reason::no_gradient, {0, 0, 2}));
  EXPECT_FALSE(in.has_reason(Reason::one_sided_gradient, {0, 0, 2}));
}

// Periods of 12 voxels from -3 on cut leaves in the middle; u depends on all coordinates through a hash, so any wrong
// neighbour shows. Voxels beyond the period are not active.
TEST(CentralDifference, WrapsAroundPeriods) {
  const std::int32_t first = -3;
  const std::int32_t n = 12;
  const Lattice lattice = periodic_lattice(0.25, first, n);
  FakeInput in(make_topology({first, first, first}, {first + n - 1, first + n - 1, first + n - 1}), lattice);
  const auto u = [](const Coord& c, int i) {
    return static_cast<double>(static_cast<float>(noise(c, static_cast<std::uint64_t>(i))));
  };
  in.set("velocity", 3, u);
  const SparseField& g = in.derive("velocity_gradient");
  const auto image = [&](Coord c) {
    const auto fold = [&](std::int32_t i) { return i < first ? i + n : i >= first + n ? i - n : i; };
    return Coord{fold(c.x), fold(c.y), fold(c.z)};
  };
  in.for_each([&](const Coord& c) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double above = u(image(step(c, j, 1)), i);
        const double below = u(image(step(c, j, -1)), i);
        // One rounding to float of the result.
        EXPECT_NEAR(static_cast<double>(g.value(c, 3 * i + j)), (above - below) / 0.5, 0x1p-23 * (above + below) / 0.5);
      }
  });
  EXPECT_EQ(in.mask().count(Reason::one_sided_gradient), 0U);
}

TEST(CentralDifference, OneSidedThroughThePeriod) {
  // Six voxels in a period along x, of which 5, 0 and 1 are there: 1 sees 0 and, through the boundary, 5.
  Lattice lattice(1, {0, 0, 0});
  lattice.set_periods({{0, 0, 0}, {6, 1, 1}, {true, false, false}});
  FakeInput in(make_topology({0, 0, 0}, {5, 0, 0}, [](const Coord& c) { return c.x < 2 || c.x == 5; }), lattice);
  in.set("velocity", 3, [](const Coord& c, int) {
    const double x = c.x == 5 ? -1 : c.x;
    return x * x;
  });
  EXPECT_EQ(in.value("velocity_gradient", {5, 0, 0}), -2);
  EXPECT_EQ(in.value("velocity_gradient", {0, 0, 0}), 0);
  EXPECT_EQ(in.value("velocity_gradient", {1, 0, 0}), 2);
}

// The relative error at the steepest point of a sine is 1 - sin(kh)/(kh) = (kh)²/6 - (kh)⁴/120 + …, and of the
// three-point one-sided formula, real part of (4(e^{ikh}-1) - (e^{2ikh}-1))/(2ikh), it is (kh)²/3 + O(kh)⁴ towards
// larger values.
TEST(CentralDifference, ConvergesWithSecondOrder) {
  for (int n : {16, 32, 64}) {
    const double h = 1.0 / n;
    const double kh = 2 * std::numbers::pi * h;
    const Lattice lattice(h, {-h / 2, -h / 2, -h / 2});  // a voxel centre at 0
    FakeInput in(make_topology({-n / 4, 0, 0}, {n / 4, 0, 0}), lattice);
    in.set("velocity", 3, [&](const Coord& c, int) { return std::sin(2 * std::numbers::pi * lattice.centre(0, c.x)); });
    const double central = in.value("velocity_gradient") / (2 * std::numbers::pi);
    // Rounding of the velocities to float, 2⁻²⁵ sin(kh) each side, over 2 kh.
    EXPECT_NEAR(1 - central, kh * kh / 6, std::pow(kh, 4) / 100 + 0x1p-23) << n;

    FakeInput half(make_topology({0, 0, 0}, {n / 4, 0, 0}), lattice);
    half.set("velocity", 3,
             [&](const Coord& c, int) { return std::sin(2 * std::numbers::pi * lattice.centre(0, c.x)); });
    const double one_sided = half.value("velocity_gradient") / (2 * std::numbers::pi);
    EXPECT_NEAR(one_sided - 1, kh * kh / 3, std::pow(kh, 4) / 3 + 0x1p-21) << n;
  }
}

TEST(ShearRate, OfSimpleShearRotationAndDilation) {
  FakeInput in = one_voxel();
  in.set("velocity_gradient", {0, 0, 2.5, 0, 0, 0, 0, 0, 0});
  EXPECT_FLOAT_EQ(static_cast<float>(in.value("shear_rate")), 2.5F);

  FakeInput rotation = one_voxel();
  rotation.set("velocity_gradient", {0, -0.3, 0.7, 0.3, 0, -1.1, -0.7, 1.1, 0});
  EXPECT_EQ(rotation.value("shear_rate"), 0);

  FakeInput dilation = one_voxel();
  dilation.set("velocity_gradient", {0.7, 0, 0, 0, 0.7, 0, 0, 0, 0.7});
  EXPECT_NEAR(dilation.value("shear_rate"), 0, 1e-15);  // rounding of the trace in double
}

// A rotating block, given as velocities: D vanishes also at the edges, where differences are one-sided.
TEST(ShearRate, VanishesInARigidRotation) {
  const Lattice lattice(0.5, {0, 0, 0});
  FakeInput in(make_topology({-5, -5, -5}, {5, 5, 5}, ragged), lattice);
  in.set("velocity", 3, [&](const Coord& c, int i) {
    const Vec3 x = lattice.centre(c);
    const Vec3 w{0.5, -1.25, 2};
    return i == 0 ? w[1] * x[2] - w[2] * x[1] : i == 1 ? w[2] * x[0] - w[0] * x[2] : w[0] * x[1] - w[1] * x[0];
  });
  const SparseField& rate = in.derive("shear_rate");
  std::size_t zeros = 0;
  in.for_each([&](const Coord& c) {
    if (in.has_reason(Reason::no_gradient, c)) {
      EXPECT_TRUE(std::isnan(rate.value(c)));
    } else {
      EXPECT_EQ(rate.value(c), 0.0F);
      ++zeros;
    }
  });
  EXPECT_GT(zeros, 300U);
}

}  // namespace
}  // namespace grainvdb::testing::gradients_test
