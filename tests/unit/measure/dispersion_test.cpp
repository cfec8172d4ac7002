// Diffusion of random walkers of known diffusivity, through periodic boundaries, with drift, losses and refusals.
#include "measure/dispersion.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::dispersion_test {
namespace {

const Box cell{{0, 0, 0}, {6, 4, 20}, {true, true, false}};
constexpr double dt = 0.5;

/// Walkers with normal steps of a standard deviation and a drift, dumped wrapped into the box.
class Walk {
 public:
  Walk(std::size_t n, double step, Vec3 drift, std::uint64_t seed)
      : scene_(poisson(cell, n, seed)), step_(step), drift_(drift), random_(seed + 1000) {}

  Frame next() {
    Frame f = scene_.frame();
    f.time = dt * frame_++;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < scene_.size(); ++i) {
        f.particles.position[a][i] = cell.wrap(static_cast<int>(a), scene_.position[a][i]);
        scene_.position[a][i] += drift_[a] * dt + step_ * random_.normal();
      }
    return f;
  }

 private:
  Scene scene_;
  double step_;
  Vec3 drift_;
  Random random_;
  int frame_ = 0;
};

constexpr MeanMotion about_mean{MeanMotion::Kind::mean};

TEST(Dispersion, FindsTheDiffusivityOfRandomWalkers) {
  constexpr double step = 0.2, expected = step * step / (2 * dt), drift = -1.3;
  constexpr int runs = 12;
  double chi2 = 0, length_chi2 = 0, mean = 0, error = 0;
  for (int run = 0; run < runs; ++run) {
    Walk walk(800, step, {0, 0, drift}, 70 + static_cast<std::uint64_t>(run));
    Dispersion d({}, 0);
    for (int frame = 0; frame < 21; ++frame) d.add(walk.next(), about_mean);
    ASSERT_EQ(d.lags(), 20U);
    EXPECT_NEAR(d.time(19), 20 * dt, 1e-12);
    EXPECT_NEAR(d.travelled(19), -drift * 20 * dt, 5 * step * std::sqrt(20.0 / 800));
    for (std::size_t a = 0; a < 3; ++a) {
      const Diffusivity by_time = d.diffusivity(a, Dispersion::Against::time, 0);
      const Diffusivity by_way = d.diffusivity(a, Dispersion::Against::travelled, 0);
      chi2 += std::pow((by_time.value - expected) / by_time.error, 2) / (3 * runs);
      length_chi2 += std::pow((by_way.value - expected / -drift) / by_way.error, 2) / (3 * runs);
      mean += by_time.value / (3 * runs);
      error += by_time.error / (3 * runs);
    }
  }
  EXPECT_NEAR(mean, expected, 4 * error / std::sqrt(3.0 * runs));
  EXPECT_LT(error, 0.1 * expected);
  // Squares over those of errors from ten slabs: on average 9/7, with a scatter of some 0.4 over 36 of them.
  EXPECT_NEAR(chi2, 9.0 / 7, 1);
  EXPECT_NEAR(length_chi2, 9.0 / 7, 1);
}

TEST(Dispersion, GrowsByTheStepsVarianceInEachStep) {
  Walk walk(4000, 0.1, {0.4, 0, 0}, 5);
  Dispersion d({}, 4);
  for (int frame = 0; frame < 13; ++frame) d.add(walk.next(), about_mean);
  ASSERT_EQ(d.lags(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(d.grains(k), 3 * 4000);  // three windows
    const double expected = 0.01 * (static_cast<double>(k) + 1);
    // A sample variance of n normal numbers scatters by √(2/n) of itself.
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(d.variance(k, a), expected, 5 * expected * std::sqrt(2.0 / 12000));
  }
}

TEST(Dispersion, IsNoneInRigidAndInAffineMotion) {
  for (const bool affine : {false, true}) {
    Scene s = poisson(cell, 100, 3);
    Dispersion d({}, 0);
    for (int frame = 0; frame < 4; ++frame) {
      Frame f = s.frame();
      f.time = frame;
      d.add(f, {affine ? MeanMotion::Kind::linear : MeanMotion::Kind::mean});
      for (std::size_t i = 0; i < s.size(); ++i) s.position[0][i] += affine ? 0.05 * s.position[2][i] : 0.9;
    }
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(d.variance(2, a), 0, 1e-20);
  }
}

TEST(Dispersion, FollowsThoseThatStay) {
  Scene s = poisson(cell, 10, 3);
  Frame first = s.frame(), second = s.frame();
  first.time = 0;
  second.time = 1;
  auto& p = second.particles;
  for (auto& column : p.position) column.erase(column.begin() + 4);
  p.id.erase(p.id.begin() + 4);
  p.radius.erase(p.radius.begin() + 4);
  p.id.back() = 99;  // another grain in the place of one that is gone
  Dispersion d({}, 0);
  d.add(first, about_mean);
  d.add(second, about_mean);
  EXPECT_EQ(d.grains(0), 8);
  EXPECT_EQ(d.variance(0, 0), 0);
}

TEST(Dispersion, RefusesStepsThatMayBeLongerThanHalfTheBox) {
  Walk walk(50, 0.1, {}, 8);
  Dispersion d({}, 0);
  for (int frame = 0; frame < 6; ++frame) {
    Frame f = walk.next();
    for (auto& column : f.particles.velocity) column.assign(f.particles.size(), 0.1);
    if (frame == 3) f.particles.velocity[1][17] = 4.1;  // 2.05 in half a time unit, of a length of 4
    d.add(f, about_mean);
  }
  EXPECT_EQ(d.refused_steps(), 2U);  // into that frame and out of it
  EXPECT_EQ(d.lags(), 2U);
  EXPECT_EQ(d.grains(0), 2 * 50);
  EXPECT_EQ(d.grains(1), 50);
}

// Grains that have fallen out of a silo are fast; those within the box are followed all the same.
TEST(Dispersion, GrainsThatAreNotFollowedMayBeFast) {
  Walk walk(200, 0, {}, 8);
  const double floor = 5;
  Dispersion d(CountedRegion({{"lo", std::vector<double>{0, 0, floor}}, {"hi", std::vector<double>{6, 4, 20}}}), 0);
  std::size_t followed = 0;
  for (int frame = 0; frame < 3; ++frame) {
    Frame f = walk.next();
    for (auto& column : f.particles.velocity) column.assign(f.particles.size(), 0.1);
    followed = 0;
    for (std::size_t i = 0; i < f.particles.size(); ++i) {
      const bool fallen = f.particles.position[2][i] < floor;
      if (fallen) f.particles.velocity[1][i] = 4.1;
      followed += fallen ? 0 : 1;
    }
    d.add(f, about_mean);
  }
  EXPECT_EQ(d.refused_steps(), 0U);
  EXPECT_EQ(d.grains(1), static_cast<double>(followed));
  EXPECT_LT(followed, 200U);
}

TEST(Dispersion, IsUndefinedWithoutSteps) {
  Dispersion d({}, 0);
  d.add(Walk(5, 0.1, {}, 1).next(), about_mean);
  EXPECT_EQ(d.lags(), 0U);
  EXPECT_TRUE(std::isnan(d.diffusivity(0, Dispersion::Against::time, 0).value));
}

TEST(Dispersion, HasNoDiffusivityInTimeWithoutTimes) {
  Walk walk(2000, 0.1, {0, 0, -1}, 8);
  Dispersion d({}, 0);
  for (int frame = 0; frame < 6; ++frame) {
    Frame f = walk.next();
    f.time.reset();
    d.add(f, about_mean);
  }
  EXPECT_TRUE(std::isnan(d.diffusivity(0, Dispersion::Against::time, 0).value));
  // Steps of 0.01 in variance, 0.5 in way. The variance of 2000 walkers scatters by 3 %: within a fifth.
  EXPECT_NEAR(d.diffusivity(0, Dispersion::Against::travelled, 0).value, 0.01, 0.002);
}

}  // namespace
}  // namespace grainvdb::testing::dispersion_test
