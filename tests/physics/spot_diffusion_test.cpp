// How particles spread under the basic spot model. The steps of spots that move a particle are, each by itself, -1/w of
// one of (±Δx, ±Δy, Δz): if they were independent, particles would have b_p = b/w. They are not: a spot that goes
// sideways leaves the particle behind on one side, and while it holds the particle it goes back as often as on. With
// ε_m the sign of Δx in step m and c_m the middle of that step,
//     b_p/b = s/w,  s = 1 + 2 Σ_m n_m ⟨ε_0 ε_m C(|c_m - c_0|)⟩,
// where C(r) is the share of the places of a spot that hold a particle both there and a distance r away, and n_m the
// number of pairs of steps that are m apart, per step. In a short time there are no pairs and s = 1.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/jackknife.hpp"
#include "physics/spot_scene.hpp"
#include "spot/random_packing.hpp"

namespace grainvdb::testing::spot_diffusion_test {
namespace {

/// Probabilities of the sum of n signs: of -n, -n+2, …, n.
std::vector<double> sums_of_signs(std::size_t n) {
  std::vector<double> p{1};
  for (std::size_t k = 0; k < n; ++k) {
    std::vector<double> q(p.size() + 1);
    for (std::size_t i = 0; i < p.size(); ++i) {
      q[i] += 0.5 * p[i];
      q[i + 1] += 0.5 * p[i];
    }
    p = q;
  }
  return p;
}

/// ⟨ε_0 ε_m C(|c_m - c_0|)⟩: c_m - c_0 is half of each end's step and all of those between.
double pair_correlation(const spot::SpotParameters& p, std::size_t m) {
  const std::vector<double> between = sums_of_signs(m - 1), ends = sums_of_signs(2);
  const double z = static_cast<double>(m) * p.step[2];
  const auto place = [&](std::size_t k, double end, double step) {
    return (2 * static_cast<double>(k) - static_cast<double>(m - 1) + end) * step;
  };
  double sum = 0;
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      for (int ends_x = -1; ends_x <= 1; ++ends_x)
        for (int ends_y = -1; ends_y <= 1; ++ends_y) {
          const double x = place(i, ends_x, p.step[0]), y = place(j, ends_y, p.step[1]);
          const double probability = between[i] * between[j] * ends[static_cast<std::size_t>(ends_x + 1)] *
                                     ends[static_cast<std::size_t>(ends_y + 1)];
          const double sign = ends_x == 0 ? -1 : 1;
          sum += sign * probability * common_share(std::sqrt(x * x + y * y + z * z), p.radius);
        }
  return sum;
}

/// s after a time in which a spot makes `steps` steps on average; their number has a Poisson distribution.
double share(const spot::SpotParameters& p, double steps) {
  const auto last = static_cast<std::size_t>(2 * p.radius / p.step[2]);  // steps that are farther apart share nothing
  double s = 1;
  for (std::size_t m = 1; m <= last; ++m) {
    // Σ_n P(n) max(n - m, 0) = steps - m + Σ_{n<m} P(n) (m - n).
    double pairs = steps - static_cast<double>(m);
    for (std::size_t n = 0; n < m; ++n)
      pairs += std::exp(static_cast<double>(n) * std::log(steps) - steps - std::lgamma(static_cast<double>(n) + 1)) *
               static_cast<double>(m - n);
    s += 2 * pairs / steps * pair_correlation(p, m);
  }
  return s;
}

/// w b_p/b of particles, b_p = ⟨Δx²⟩/(2⟨-Δz⟩), over that many independent rounds of `steps` steps.
Measured measured_share(double steps, int rounds, spot::SpotParameters p = gentle_spots()) {
  const Box box{{0, 0, 0}, {14, 14, 60}, {true, true, true}};
  p.count = 400;
  spot::SpotModel model({box, std::nullopt}, spot::poisson_packing(box, 0.05, 1, 31), p, 32);
  Displacements displacements(model);
  const double b = p.step[0] * p.step[0] / (2 * p.step[2]);
  std::vector<double> spread, fallen;
  for (int round = 1; round <= rounds; ++round) {
    model.advance(round * steps);
    double squares = 0, down = 0;
    for (const Vec3& moved : displacements.next()) {
      squares += 0.5 * (moved[0] * moved[0] + moved[1] * moved[1]);
      down -= moved[2];
    }
    spread.push_back(squares * p.influence / b);
    fallen.push_back(2 * down);
  }
  return ratio_of_sums(spread, fallen);
}

TEST(SpotDiffusion, IsOneOverWForSingleSteps) {
  EXPECT_NEAR(share(gentle_spots(), 1e-4), 1, 1e-4);
  const Measured s = measured_share(0.02, 4000);
  EXPECT_LT(s.error, 0.02);
  EXPECT_NEAR(s.value, share(gentle_spots(), 0.02), 4 * s.error);
  EXPECT_NEAR(s.value, 1, 4 * s.error);
}

TEST(SpotDiffusion, IsLessWhereSpotsTakeParticlesBack) {
  for (const auto& [steps, rounds] : {std::pair{1.0, 800}, std::pair{5.0, 200}, std::pair{28.0, 60}}) {
    const Measured s = measured_share(steps, rounds);
    EXPECT_LT(s.error, 0.02);
    EXPECT_NEAR(s.value, share(gentle_spots(), steps), 4 * s.error) << steps;
  }
}

TEST(SpotDiffusion, Is64PerCentOf1OverWInTheLongRun) {
  EXPECT_NEAR(share(gentle_spots(), 1e5), 0.640, 5e-4);
  const Measured s = measured_share(300, 16);
  EXPECT_LT(s.error, 0.02);
  EXPECT_NEAR(s.value, share(gentle_spots(), 300), 4 * s.error);
}

// Over the whole of a passage, too, where spots hardly leave to the sides while they pass: b = 0.032 d, b/R = 0.012.
TEST(SpotDiffusion, IsOneOverWWhereSpotsRiseStraight) {
  spot::SpotParameters p = gentle_spots();
  p.step = {0.08, 0.08, 0.1};
  EXPECT_GT(share(p, 300), 0.95);
  const Measured s = measured_share(300, 16, p);
  EXPECT_LT(s.error, 0.025);
  EXPECT_NEAR(s.value, share(p, 300), 4 * s.error);
  EXPECT_NEAR(s.value, 1, 0.05 + 4 * s.error);
}

}  // namespace
}  // namespace grainvdb::testing::spot_diffusion_test
