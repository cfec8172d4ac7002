#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "unit/derive/fake_input.hpp"
#include "unit/derive/jacobi.hpp"

namespace grainvdb::testing::brute_force_test {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double h = 0.4;

bool exists(const Coord& c) {
  return c.x >= -6 && c.x <= 13 && c.y >= 0 && c.y <= 9 && c.z >= -3 && c.z <= 11 && noise(c, 1) < 0.8;
}

// Base fields of a dense flow in which every tenth voxel or so has something wrong: no material, no fluctuation,
// tension, no stress, isotropic stress.
bool material(const Coord& c) {
  return noise(c, 2) > 0.05;
}
double as_float(double v) {
  return static_cast<double>(static_cast<float>(v));
}
double phi(const Coord& c) {
  return material(c) ? as_float(0.4 + 0.2 * noise(c, 3)) : 0;
}
double density(const Coord& c) {
  return material(c) ? as_float(phi(c) * (2400 + 200 * noise(c, 4))) : 0;
}
double diameter(const Coord& c) {
  return material(c) ? as_float(8e-4 + 1e-4 * noise(c, 5)) : undefined;
}
double temperature(const Coord& c) {
  return !material(c) ? undefined : noise(c, 6) < 0.05 ? 0 : as_float(0.01 * noise(c, 7));
}
double spin(const Coord& c) {
  return !material(c) ? undefined : noise(c, 8) < 0.05 ? 0 : as_float(4e4 * noise(c, 9));
}
double velocity(const Coord& c, int i) {
  return material(c) ? as_float(0.3 * c.z + 0.2 * noise(c, 10 + static_cast<std::uint64_t>(i))) : undefined;
}
double stress(const Coord& c, int k) {
  const double kind = noise(c, 20);
  if (kind < 0.05) return 0;
  if (kind < 0.1) return k % 4 == 0 ? -250 : 0;
  const double p = kind < 0.2 ? -100 : 300;  // some tension
  return as_float(150 * (noise(c, 21 + static_cast<std::uint64_t>(k)) - 0.5) - (k % 4 == 0 ? p : 0));
}

Coord step(Coord c, int axis, int by) {
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) += by;
  return c;
}

/// ∂u_i/∂x_j from the definition in the header, and the sum of the magnitudes of its terms.
std::pair<double, double> gradient(const Coord& c, int i, int j) {
  const auto u = [&](int by) { return exists(step(c, j, by)) ? velocity(step(c, j, by), i) : undefined; };
  if (std::isnan(u(0))) return {undefined, 0};
  const auto terms = [](std::initializer_list<double> t) {
    double sum = 0;
    double magnitude = 0;
    for (double x : t) {
      sum += x;
      magnitude += std::abs(x);
    }
    return std::pair{sum, magnitude};
  };
  const bool below = !std::isnan(u(-1));
  const bool above = !std::isnan(u(1));
  if (below && above) return terms({u(1) / (2 * h), -u(-1) / (2 * h)});
  if (!below && !above) return {undefined, 0};
  const int s = above ? 1 : -1;
  if (std::isnan(u(2 * s))) return terms({s * u(s) / h, -s * u(0) / h});
  return terms({-3 * s * u(0) / (2 * h), 4 * s * u(s) / (2 * h), -s * u(2 * s) / (2 * h)});
}

/// Everything at one voxel, in double from the base fields alone.
struct Reference {
  explicit Reference(const Coord& c) {
    for (int k = 0; k < 9; ++k) {
      l[static_cast<std::size_t>(k)] = gradient(c, k / 3, k % 3).first;
      sigma[static_cast<std::size_t>(k)] = stress(c, k);
    }
    // 2 D':D' = Σ_ij ½ (L_ij + L_ji)² - (2/3) (Tr L)²
    double dd = 0;
    double ss = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        dd += 0.5 * (l[3 * i + j] + l[3 * j + i]) * (l[3 * i + j] + l[3 * j + i]);
        ss += sigma[3 * i + j] * sigma[3 * i + j];
      }
    const double tr = l[0] + l[4] + l[8];
    value["shear_rate"] = rate = std::sqrt(dd - 2 * tr * tr / 3);
    pressure = -(sigma[0] + sigma[4] + sigma[8]) / 3;
    value["pressure"] = pressure;
    terms["pressure"] = (std::abs(sigma[0]) + std::abs(sigma[4]) + std::abs(sigma[8])) / 3;
    const double shear = std::sqrt(std::max(0.0, ss - 3 * pressure * pressure) / 2);
    value["shear_stress"] = shear;
    const double mu = pressure > 0 ? shear / pressure : undefined;
    value["mu"] = mu;
    value["inertial_number"] =
        pressure > 0 && phi(c) > 0 ? rate * diameter(c) * std::sqrt(density(c) / phi(c) / pressure) : undefined;
    const double inertial = value["inertial_number"];
    value["regime"] = std::isnan(inertial) ? undefined : inertial < 1e-3 ? 0 : inertial > 0.1 ? 2 : 1;
    const double g = mu > 1e-6 ? rate / mu : undefined;
    value["fluidity"] = g;
    value["gd_over_dv"] = temperature(c) > 0 ? g * diameter(c) / std::sqrt(temperature(c)) : undefined;
    value["rotational_temperature"] = diameter(c) * diameter(c) * spin(c) / 10;
    value["g_over_domega"] = spin(c) > 0 ? g / std::sqrt(spin(c)) : undefined;
    // T = 0 in a voxel that moves: below the resolution of velocities.
    value["dv_over_d_domega"] =
        spin(c) > 0 && temperature(c) > 0 ? std::sqrt(temperature(c)) / (diameter(c) * std::sqrt(spin(c))) : undefined;
    const Eigen3 s = jacobi(sigma);
    const double p1 = -s.values[0];
    const double p3 = -s.values[2];
    value["mu_mohr_coulomb"] = pressure > 0 && p1 > 1e-7 * p3 ? (p3 - p1) / (2 * std::sqrt(p1 * p3)) : undefined;
    terms["mu_mohr_coulomb"] = (p3 + p1) / (2 * std::sqrt(p1 * p3));
  }
  std::array<double, 9> l{};
  std::array<double, 9> sigma{};
  double rate = 0;
  double pressure = 0;
  std::map<std::string, double> value;
  std::map<std::string, double> terms;  ///< the sum of |terms| where they can cancel
};

FakeInput random_flow() {
  FakeInput in(make_topology({-6, 0, -3}, {13, 9, 11}, exists), Lattice(h, {0.1, 0.2, 0.3}));
  const auto scalar = [](double (*f)(const Coord&)) { return [f](const Coord& c, int) { return f(c); }; };
  in.set("phi", 1, scalar(phi));
  in.set("density", 1, scalar(density));
  in.set("mean_diameter", 1, scalar(diameter));
  in.set("temperature", 1, scalar(temperature));
  in.set("rotational_fluctuation", 1, scalar(spin));
  in.set("velocity", 3, velocity);
  in.set("angular_velocity", 3, velocity);
  in.set("stress", 9, stress);
  return in;
}

// Every value is formed in double and rounded to float once per stage on the way, at most four times: 4 · 2⁻²⁴
// = 2.4e-7. The reference's own sums of squares cancel to 1e-15, 3e-8 of the root at worst. Sums that cancel (gradient,
// pressure, μ_MC) are compared relative to the sum of their |terms|.
TEST(BruteForce, EveryDerivedFieldAtEveryVoxel) {
  FakeInput in = random_flow();
  std::map<std::string, std::size_t> defined;
  std::map<std::string, std::size_t> masked;
  in.derive("velocity_gradient");
  in.derive("angular_velocity_gradient");
  in.for_each([&](const Coord& c) {
    for (int k = 0; k < 9; ++k) {
      const double of_spin = in.value("angular_velocity_gradient", c, k);
      const double of_velocity = in.value("velocity_gradient", c, k);
      EXPECT_TRUE(of_spin == of_velocity || (std::isnan(of_spin) && std::isnan(of_velocity)));
      const auto [expected, terms] = gradient(c, k / 3, k % 3);
      const double v = in.value("velocity_gradient", c, k);
      ASSERT_EQ(std::isnan(v), std::isnan(expected));
      if (std::isnan(v)) continue;
      EXPECT_NEAR(v, expected, 1e-6 * terms);
    }
    const Reference reference(c);
    for (const auto& [name, expected] : reference.value) {
      const double v = in.value(name, c);
      ASSERT_EQ(std::isnan(v), std::isnan(expected)) << name << ' ' << c.x << ' ' << c.y << ' ' << c.z;
      ++(std::isnan(v) ? masked : defined)[name];
      if (std::isnan(v)) continue;
      const auto terms = reference.terms.find(name);
      const double scale = terms == reference.terms.end() ? std::abs(expected) : terms->second;
      EXPECT_NEAR(v, expected, 1e-6 * scale) << name;
    }
  });
  for (const auto& [name, count] : defined) {
    EXPECT_GT(count, 1000U) << name;
    if (name == "pressure" || name == "shear_stress") continue;
    EXPECT_GT(masked[name], 50U) << name;
  }
}

// Slip lines and angles too: a NaN has a reason of the kinds that belong to its field, or the material is missing.
TEST(BruteForce, NoNaNWithoutAReasonAndNoInfinity) {
  FakeInput in = random_flow();
  for (const Stage& stage : in.registry().stages()) in.derive(stage.name);
  for (const Stage& stage : in.registry().stages()) {
    if (stage.name == "velocity" || stage.name == "angular_velocity") continue;
    in.for_each([&](const Coord& c) {
      for (double v : in.values(stage.name, c)) {
        EXPECT_FALSE(std::isinf(v)) << stage.name;
        EXPECT_FALSE(std::isnan(v) && material(c) && in.reasons_at(c) == 0) << stage.name;
      }
    });
  }
}

TEST(BruteForce, InactiveVoxelsAreNeitherReadNorWritten) {
  FakeInput in = random_flow();
  for (const Stage& stage : in.registry().stages()) {
    if (stage.name == "velocity" || stage.name == "angular_velocity") continue;
    const SparseField& field = in.derive(stage.name);
    for (std::size_t l = 0; l < in.topology().leaf_count(); ++l)
      for (int k = 0; k < field.components(); ++k)
        for (int v = 0; v < leaf_size; ++v) {
          const float value = field.leaf(l, k)[v];
          if (!in.topology().mask(l).test(v)) {
            ASSERT_TRUE(std::isnan(value)) << stage.name;  // the background
          } else if (std::isfinite(value)) {
            // Inputs are below 1e4; anything made from a neighbour of 1e30 would show.
            ASSERT_LT(std::abs(value), 1e12F) << stage.name;
          }
        }
  }
}

std::vector<float> bytes_with_threads(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  FakeInput in = random_flow();
  std::vector<float> all;
  for (const Stage& stage : in.registry().stages()) {
    const SparseField& field = in.derive(stage.name);
    for (std::size_t l = 0; l < in.topology().leaf_count(); ++l)
      for (int k = 0; k < field.components(); ++k)
        in.topology().mask(l).for_each([&](int v) { all.push_back(field.leaf(l, k)[v]); });
  }
  for (std::size_t l = 0; l < in.topology().leaf_count(); ++l)
    for (int v = 0; v < leaf_size; ++v) all.push_back(static_cast<float>(in.mask().leaf(l)[v]));
  return all;
}

TEST(BruteForce, SameBytesForAnyNumberOfThreads) {
  const std::vector<float> one = bytes_with_threads(1);
  const std::vector<float> four = bytes_with_threads(4);
  ASSERT_EQ(one.size(), four.size());
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(float)), 0);
}

}  // namespace
}  // namespace grainvdb::testing::brute_force_test
