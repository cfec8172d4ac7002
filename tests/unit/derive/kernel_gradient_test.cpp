#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fields/moments.hpp"
#include "unit/derive/fake_input.hpp"

namespace grainvdb::testing::kernel_gradient_test {
namespace {

void use_kernel_method(FakeInput& in) {
  in.set_option("velocity_gradient", "method", std::string("kernel"));
}

// Moments of a smooth weight w and velocity u; the quotient rule must give back ∂u_i/∂x_j.
TEST(KernelGradient, IsTheDerivativeOfTheQuotient) {
  const Lattice lattice(0.25, {-1, -1, -1});
  FakeInput in(make_topology({0, 0, 0}, {8, 8, 8}), lattice);
  use_kernel_method(in);
  const auto at = [&](const Coord& c) { return lattice.centre(c); };
  const auto w = [](const Vec3& x) { return 1.5 + 0.3 * x[0] - 0.2 * x[1] * x[2]; };
  const auto dw = [](const Vec3& x, int j) { return j == 0 ? 0.3 : j == 1 ? -0.2 * x[2] : -0.2 * x[1]; };
  const auto u = [](const Vec3& x, int i) { return 40 + std::sin((i + 1) * x[0] + 2 * x[1] - x[2]); };
  const auto du = [](const Vec3& x, int i, int j) {
    const double k = j == 0 ? i + 1 : j == 1 ? 2 : -1;
    return k * std::cos((i + 1) * x[0] + 2 * x[1] - x[2]);
  };
  const StageSettings& s = in.settings();
  in.set_moment(*velocity_denominator(s), [&](const Coord& c, int) { return w(at(c)); });
  in.set_moment(*velocity_numerator(s), [&](const Coord& c, int i) { return w(at(c)) * u(at(c), i); });
  in.set_moment(*velocity_denominator_gradient(s), [&](const Coord& c, int j) { return dw(at(c), j); });
  in.set_moment(*velocity_numerator_gradient(s), [&](const Coord& c, int k) {
    return dw(at(c), k % 3) * u(at(c), k / 3) + w(at(c)) * du(at(c), k / 3, k % 3);
  });
  const SparseField& g = in.derive("velocity_gradient");
  in.for_each([&](const Coord& c) {
    const Vec3 x = at(c);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        // One rounding to float, and double rounding of terms of up to 41·0.5/w.
        EXPECT_NEAR(static_cast<double>(g.value(c, 3 * i + j)), du(x, i, j), 0x1p-24 * std::abs(du(x, i, j)) + 1e-14);
  });
}

struct Grain {
  Vec3 x, v;
  double volume;
};

double lucy(double r, double c) {
  const double q = r / c;
  return q < 1 ? 105 / (16 * std::numbers::pi * c * c * c) * std::pow(1 - q, 3) * (1 + 3 * q) : 0;
}

// Grains given one by one: the result must be the numerical derivative of u(x) = Σ V v W/Σ V W, which knows nothing of
// ∇W.
TEST(KernelGradient, IsTheNumericalDerivativeOfTheKernelSums) {
  const double cut = 1.3;
  std::vector<Grain> grains;
  for (std::int32_t k = 0; k < 60; ++k) {
    const auto r = [k](std::uint64_t seed) { return noise({k, 0, 0}, seed); };
    grains.push_back({{2 * r(1), 2 * r(2), 2 * r(3)}, {5 + r(4), r(5) - 2, 3 * r(6)}, 0.05 + 0.1 * r(7)});
  }
  const auto sums = [&](const Vec3& x) {
    std::array<double, 4> s{};
    for (const Grain& a : grains) {
      const double w = a.volume * lucy(std::hypot(x[0] - a.x[0], x[1] - a.x[1], x[2] - a.x[2]), cut);
      for (std::size_t i = 0; i < 3; ++i) s[i] += w * a.v[i];
      s[3] += w;
    }
    return s;
  };
  const auto gradient_sums = [&](const Vec3& x) {
    std::array<double, 12> s{};
    for (const Grain& a : grains) {
      const Vec3 d{x[0] - a.x[0], x[1] - a.x[1], x[2] - a.x[2]};
      const double q = std::hypot(d[0], d[1], d[2]) / cut;
      if (q >= 1) continue;
      const double f = -1260 / (16 * std::numbers::pi * std::pow(cut, 5)) * (1 - q) * (1 - q) * a.volume;
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) s[3 * i + j] += f * d[j] * a.v[i];
        s[9 + j] += f * d[j];
      }
    }
    return s;
  };

  const Lattice lattice(0.2, {0, 0, 0});
  FakeInput in(make_topology({0, 0, 0}, {9, 9, 9}), lattice);
  use_kernel_method(in);
  const StageSettings& s = in.settings();
  const auto at = [&](const Coord& c) { return lattice.centre(c); };
  const auto index = [](int k) { return static_cast<std::size_t>(k); };
  in.set_moment(*velocity_denominator(s), [&](const Coord& c, int) { return sums(at(c))[3]; });
  in.set_moment(*velocity_numerator(s), [&](const Coord& c, int i) { return sums(at(c))[index(i)]; });
  in.set_moment(*velocity_denominator_gradient(s),
                [&](const Coord& c, int j) { return gradient_sums(at(c))[index(9 + j)]; });
  in.set_moment(*velocity_numerator_gradient(s), [&](const Coord& c, int k) { return gradient_sums(at(c))[index(k)]; });
  const SparseField& g = in.derive("velocity_gradient");
  const double e = 1e-5;
  in.for_each([&](const Coord& c) {
    for (std::size_t j = 0; j < 3; ++j) {
      Vec3 above = at(c);
      Vec3 below = at(c);
      above[j] += e;
      below[j] -= e;
      const auto sa = sums(above);
      const auto sb = sums(below);
      for (std::size_t i = 0; i < 3; ++i) {
        const double numerical = (sa[i] / sa[3] - sb[i] / sb[3]) / (2 * e);
        // The numerical derivative is off by e² u'''/6 ~ 1e-9 and by double rounding of u ~ 6 over e ~ 1e-10; float
        // adds 6e-8.
        EXPECT_NEAR(static_cast<double>(g.value(c, static_cast<int>(3 * i + j))), numerical,
                    1e-7 * std::max(1.0, std::abs(numerical)));
      }
    }
  });
}

// The two sums of the quotient rule cancel to double rounding where the velocity is constant.
TEST(KernelGradient, PlugFlowIsZeroToRoundingOfDouble) {
  FakeInput in = one_voxel();
  use_kernel_method(in);
  const StageSettings& s = in.settings();
  const double v = 12.3;
  in.set_moment(*velocity_denominator(s), [](const Coord&, int) { return 0.37; });
  in.set_moment(*velocity_numerator(s), [v](const Coord&, int) { return 0.37 * v; });
  in.set_moment(*velocity_denominator_gradient(s), [](const Coord&, int j) { return 0.1 * (j + 1); });
  in.set_moment(*velocity_numerator_gradient(s), [v](const Coord&, int k) { return 0.1 * (k % 3 + 1) * v; });
  for (double g : in.values("velocity_gradient")) EXPECT_NEAR(g, 0, 4 * 0x1p-53 * v * 0.3 / 0.37);
}

TEST(KernelGradient, NoMaterialNoGradient) {
  FakeInput in = one_voxel();
  use_kernel_method(in);
  const StageSettings& s = in.settings();
  for (const MomentPtr& m : {velocity_denominator(s), velocity_numerator(s), velocity_denominator_gradient(s),
                             velocity_numerator_gradient(s)})
    in.set_moment(*m, [](const Coord&, int) { return 0.0; });
  for (double g : in.values("velocity_gradient")) EXPECT_TRUE(std::isnan(g));
  EXPECT_EQ(in.reasons_at({}), static_cast<std::uint32_t>(Reason::no_material));
}

TEST(KernelGradient, NeedsTheMomentsOfTheChosenWeighting) {
  FakeInput in = one_voxel();
  const Stage& stage = *in.registry().find("velocity_gradient");
  const auto names = [&] {
    std::vector<std::string> n;
    for (const MomentPtr& m : stage.needs(in.settings()).moments) n.push_back(m->name);
    std::sort(n.begin(), n.end());
    return n;
  };
  EXPECT_TRUE(names().empty());
  EXPECT_EQ(stage.needs(in.settings()).fields, std::vector<std::string>{"velocity"});
  use_kernel_method(in);
  EXPECT_TRUE(stage.needs(in.settings()).fields.empty());
  const std::vector<std::string> by_volume = names();
  EXPECT_EQ(by_volume.size(), 4U);
  in.set_option("velocity", "weighting", std::string("mass"));
  std::vector<std::string> shared;
  const std::vector<std::string> by_mass = names();
  std::set_intersection(by_volume.begin(), by_volume.end(), by_mass.begin(), by_mass.end(), std::back_inserter(shared));
  EXPECT_EQ(by_mass.size(), 4U);
  EXPECT_TRUE(shared.empty());
}

}  // namespace
}  // namespace grainvdb::testing::kernel_gradient_test
