// C(r) of grains that move with spheres of influence, of rigid and of independent motion, and the fitted radius.
#include "measure/velocity_correlation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "lattices.hpp"
#include "measure/cell_grid.hpp"
#include "measure/fluctuations.hpp"

namespace grainvdb::testing::velocity_correlation_test {
namespace {

const Box bed{{0, 0, 0}, {30, 12, 12}, {true, true, true}};

/// Each of many spheres at random places moves all grains within R of it by a random vector of its own.
Columns3 moved_by_spheres(const Scene& s, double radius, std::size_t spheres, Random& random) {
  const CellGrid grid(s.box, s.position, radius);
  Columns3 u;
  for (auto& column : u) column.assign(s.size(), 0);
  for (std::size_t n = 0; n < spheres; ++n) {
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = random.uniform(s.box.lo[a], s.box.hi[a]);
    const Vec3 kick = random.normal3();
    grid.around(x, [&](std::size_t j, const Vec3&, double) {
      for (std::size_t a = 0; a < 3; ++a) u[a][j] += kick[a];
    });
  }
  return u;
}

struct Fit {
  double radius, error, amplitude;
};

Fit fit(const VelocityCorrelation& c) {
  const auto of = [&](const std::vector<double>& values) {
    std::vector<double> r;
    for (std::size_t k = 0; k < c.bins(); ++k) r.push_back(c.middle(k));
    return fit_sphere_law(r, values);
  };
  std::vector<double> all, radii;
  for (std::size_t k = 0; k < c.bins(); ++k) all.push_back(c.c(k));
  for (std::size_t slab = 0; slab < Slabs::count; ++slab)
    if (const auto without = c.without(slab); !without.empty()) radii.push_back(of(without).radius);
  const SphereFit whole = of(all);
  return {whole.radius, jackknife_error(radii), whole.amplitude};
}

TEST(VelocityCorrelation, IsTheCommonPartOfSpheresOfInfluence) {
  constexpr double radius = 1.5;
  constexpr int runs = 8, frames = 12;
  std::vector<double> mean(25);
  double chi2 = 0, error = 0, radii = 0;
  Random random(20);
  for (int run = 0; run < runs; ++run) {
    const Scene s = poisson(bed, 1200, 50 + static_cast<std::uint64_t>(run));
    VelocityCorrelation c(5, 25);
    for (int frame = 0; frame < frames; ++frame)
      c.add(bed, s.position, moved_by_spheres(s, radius, 600, random), Slabs(bed));
    for (std::size_t k = 0; k < 25; ++k) mean[k] += c.c(k) / runs;
    const Fit f = fit(c);
    chi2 += std::pow((f.radius - radius) / f.error, 2) / runs;
    error += f.error / runs;
    radii += f.radius / runs;
  }
  // The error of the mean of runs, by those that each states; and how far the runs lie apart, by the same.
  EXPECT_NEAR(radii, radius, 4 * error / std::sqrt(runs));
  EXPECT_LT(error, 0.05 * radius);
  EXPECT_LT(chi2, 3) << "the stated error is too small";
  EXPECT_GT(chi2, 0.2) << "the stated error is too large";
  for (std::size_t k = 1; k < 25; ++k)
    EXPECT_NEAR(mean[k], sphere_law((static_cast<double>(k) + 0.5) / 5, radius), 0.04);
}

TEST(VelocityCorrelation, IsOneWhereAllMoveAlikeAndNoneWhereEachMovesByItself) {
  const Scene s = poisson(bed, 800, 4);
  Columns3 alike, alone;
  Random random(9);
  for (auto& column : alike) column.assign(s.size(), 0.3);
  for (auto& column : alone)
    for (std::size_t i = 0; i < s.size(); ++i) column.push_back(random.normal());
  VelocityCorrelation one(5, 10), none(5, 10);
  one.add(bed, s.position, alike, Slabs(bed));
  none.add(bed, s.position, alone, Slabs(bed));
  for (std::size_t k = 1; k < 10; ++k) {
    EXPECT_NEAR(one.c(k), 1, 1e-12);
    // u·u'/√(⟨u²⟩⟨u'²⟩) of three components each has variance 1/3; pairs count in both orders.
    EXPECT_NEAR(none.c(k), 0, 5 * std::sqrt(2.0 / 3 / static_cast<double>(none.pairs(k))));
  }
}

// Each pair once, by its nearest image along periodic axes. Enough grains for several parts in each slab; the sums are
// of up to 1e5 terms, each rounded.
TEST(VelocityCorrelation, IsThatOfAllPairsForAnyNumberOfThreads) {
  constexpr double reach = 4;
  constexpr std::size_t bins = 8;
  const Box box{{0, 0, 0}, {30, 12, 12}, {true, false, true}};
  const Scene s = poisson(box, 8000, 12);
  Random random(3);
  Columns3 u;
  for (auto& column : u)
    for (std::size_t i = 0; i < s.size(); ++i) column.push_back(random.normal() + s.position[2][i]);
  struct Sums {
    double product = 0, first = 0, second = 0;
    std::size_t pairs = 0;
  };
  std::array<Sums, bins> expected{};
  const auto dot = [&](std::size_t i, std::size_t j) {
    return u[0][i] * u[0][j] + u[1][i] * u[1][j] + u[2][i] * u[2][j];
  };
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < s.size(); ++j) {
      double r2 = 0;
      for (std::size_t a = 0; a < 3; ++a)
        r2 += std::pow(box.minimum_image(static_cast<int>(a), s.position[a][j] - s.position[a][i]), 2);
      if (i == j || r2 > reach * reach) continue;
      Sums& sums = expected[std::min(bins - 1, static_cast<std::size_t>(std::sqrt(r2) * bins / reach))];
      sums.product += dot(i, j);
      sums.first += dot(i, i);
      sums.second += dot(j, j);
      ++sums.pairs;
    }
  VelocityCorrelation one(reach, bins), many(reach, bins);
  for (const auto& [c, threads] : {std::pair<VelocityCorrelation*, std::size_t>{&one, 1}, {&many, 4}}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    c->add(box, s.position, u, Slabs(box));
  }
  for (std::size_t k = 0; k < bins; ++k) {
    EXPECT_EQ(one.pairs(k), expected[k].pairs);
    EXPECT_NEAR(one.c(k), expected[k].product / std::sqrt(expected[k].first * expected[k].second), 1e-11);
    EXPECT_EQ(one.c(k), many.c(k));
    EXPECT_EQ(one.error(k), many.error(k));
  }
}

TEST(SphereLaw, HasTheValuesOfItsFormula) {
  EXPECT_DOUBLE_EQ(sphere_law(0, 2.6), 1);
  EXPECT_DOUBLE_EQ(sphere_law(2.6, 2.6), 1 - 0.75 + 0.0625);
  EXPECT_NEAR(sphere_law(5.2, 2.6), 0, 1e-15);
  EXPECT_EQ(sphere_law(6, 2.6), 0);
}

TEST(SphereLaw, IsRecoveredFromItself) {
  for (const double radius : {0.8, 2.6, 4.1})
    for (const double amplitude : {0.3, 1.0, -0.5}) {
      std::vector<double> r, c;
      for (int k = 0; k < 40; ++k) {
        r.push_back(0.2 * k + 0.1);
        c.push_back(amplitude * sphere_law(r.back(), radius));
      }
      const SphereFit f = fit_sphere_law(r, c);
      EXPECT_NEAR(f.radius, radius, 1e-6 * radius);
      EXPECT_NEAR(f.amplitude, amplitude, 1e-6);
    }
}

TEST(SphereLaw, IsNotFittedToTwoPoints) {
  EXPECT_TRUE(std::isnan(fit_sphere_law({1, 2}, {0.5, 0.2}).radius));
}

TEST(Fluctuations, HaveNothingOfTheMotionThatIsTakenOff) {
  const Scene s = poisson(bed, 300, 6);
  Columns3 u;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double x = s.position[0][i], y = s.position[1][i], z = s.position[2][i];
    u[0].push_back(0.3 + 0.1 * x - 0.2 * y + 0.7 * z);
    u[1].push_back(-1 + 0.5 * x);
    u[2].push_back(2.0);
  }
  const auto largest = [](const Columns3& c) {
    double most = 0;
    for (const auto& column : c)
      for (const double v : column) most = std::max(most, std::abs(v));
    return most;
  };
  EXPECT_LT(largest(fluctuations({MeanMotion::Kind::linear}, s.position, u)), 1e-11);
  EXPECT_GT(largest(fluctuations({MeanMotion::Kind::mean}, s.position, u)), 1);
  EXPECT_EQ(fluctuations({MeanMotion::Kind::none}, s.position, u), u);
  Columns3 layered = u;
  for (std::size_t i = 0; i < s.size(); ++i)
    for (auto& column : layered) column[i] = std::floor(s.position[2][i] / 1.5);
  EXPECT_LT(largest(fluctuations({MeanMotion::Kind::layers, 2, 1.5}, s.position, layered)), 1e-12);
}

TEST(Fluctuations, LeaveTheGradientAcrossASingleLayerAlone) {
  Scene s = poisson(bed, 50, 7);
  std::fill(s.position[1].begin(), s.position[1].end(), 1.0);
  Columns3 u = s.position;
  for (const auto& column : fluctuations({MeanMotion::Kind::linear}, s.position, u))
    for (const double v : column) EXPECT_NEAR(v, 0, 1e-11);
}

}  // namespace
}  // namespace grainvdb::testing::velocity_correlation_test
