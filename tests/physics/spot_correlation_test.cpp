// C(r) of the basic spot: two particles move together where a spot holds both. The share of the spots that hold one and
// also the other, at a distance r, is the volume that two balls of radius R have in common.
#include <cmath>

#include <gtest/gtest.h>

#include "physics/jackknife.hpp"
#include "physics/spot_scene.hpp"
#include "spot/random_packing.hpp"

namespace grainvdb::testing::spot_correlation_test {
namespace {

constexpr double bin_width = 0.5;
constexpr std::size_t bins = 13;

struct Pair {
  std::size_t i, j, bin;
};
struct Pairs {
  std::vector<Pair> list;
  std::vector<double> count = std::vector<double>(bins), law = std::vector<double>(bins);
};

/// All pairs nearer than the bins reach, and the law summed over those of each bin.
Pairs find_pairs(const Box& box, const spot::Packing& packing, double radius) {
  Pairs pairs;
  for (std::size_t i = 0; i < packing.id.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a)
        r2 += std::pow(box.minimum_image(a, packing.position[i][a] - packing.position[j][a]), 2);
      const auto bin = static_cast<std::size_t>(std::sqrt(r2) / bin_width);
      if (bin >= bins) continue;
      pairs.list.push_back({i, j, bin});
      pairs.count[bin] += 1;
      pairs.law[bin] += common_share(std::sqrt(r2), radius);
    }
  return pairs;
}

double dot(const Vec3& u, const Vec3& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

TEST(SpotCorrelation, IsTheCommonVolumeOfTwoSpots) {
  const Box box{{0, 0, 0}, {16, 16, 16}, {true, true, true}};
  const spot::Packing packing = spot::poisson_packing(box, 0.2, 1, 21);
  spot::SpotParameters p = gentle_spots();
  p.direction = spot::SpotParameters::Direction::any;
  p.count = 20'000;  // so many that hardly one makes two steps in a round, which are not independent
  spot::SpotModel model({box, std::nullopt}, packing, p, 22);
  Displacements displacements(model);
  const Pairs pairs = find_pairs(box, packing, p.radius);
  std::vector<std::vector<double>> products(bins);
  std::vector<double> squares;
  for (int round = 0; round < 150; ++round) {
    model.run_events(200);
    const std::vector<Vec3> u = displacements.next();
    double square = 0;
    for (const Vec3& v : u) square += dot(v, v);
    squares.push_back(square / static_cast<double>(u.size()));
    std::vector<double> sums(bins);
    for (const Pair& pair : pairs.list) sums[pair.bin] += dot(u[pair.i], u[pair.j]);
    for (std::size_t k = 0; k < bins; ++k) products[k].push_back(sums[k] / pairs.count[k]);
  }
  for (std::size_t k = 0; k < bins; ++k) {
    const Measured c = ratio_of_sums(products[k], squares);
    EXPECT_LT(c.error, 0.03);
    EXPECT_NEAR(c.value, pairs.law[k] / pairs.count[k], 4 * c.error + 1e-3) << "bin " << k;
  }
}

}  // namespace
}  // namespace grainvdb::testing::spot_correlation_test
