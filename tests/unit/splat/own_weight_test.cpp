#include "splat/own_weight.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "bin/buckets.hpp"
#include "splat/sample.hpp"
#include "splat/splat.hpp"
#include "unit/splat/scene.hpp"

namespace grainvdb::own_weight_test {
namespace {

/// Particles on a lattice with the sum of their weights.
struct Weighed {
  Weighed(const Scene& scene, Columns3 x, std::vector<double> w)
      : lattice(scene.lattice()), kernel(scene.cutoff), position(std::move(x)), weight(std::move(w)) {
    buckets = bin_points(lattice, position, scene.cutoff);
    topology = particle_topology(lattice, kernel, buckets);
    total = splat_particles(lattice, kernel, buckets, topology, weight, 1);
  }
  std::vector<double> factors() const {
    return deviation_factors(lattice, kernel, position, weight, total.blocks(), 0);
  }

  /// What the mean at every particle becomes when the value of particle b is 1 and that of all others 0.
  std::vector<double> response(std::size_t b) const {
    std::vector<double> q(3 * weight.size());
    q[3 * b] = weight[b];
    const LeafBuffers above = splat_particles(lattice, kernel, buckets, topology, q, 3);
    std::vector<double> shares;
    for (const Vec3& s : sample_trilinear(lattice, {above.blocks(), 0, total.blocks(), 0}, position))
      shares.push_back(s[0]);
    return shares;
  }

  Lattice lattice;
  LucyKernel kernel;
  Columns3 position;
  std::vector<double> weight;
  Buckets buckets;
  std::shared_ptr<const Topology> topology;
  LeafBuffers total;
};

std::vector<double> weights(std::size_t n) {
  std::vector<double> w = random_values(n, 7);
  for (double& x : w) x = 0.6 + 0.5 * x;
  return w;
}

class OwnWeight : public testing::TestWithParam<Scene> {};

// The definition: the mean at α is linear in the values of the particles, so its response to each of them one after
// another gives all shares. Where the kernel and a voxel more reach half around the box, two images of a particle are
// seen at once, each with less than W at c - h/2 (3e-3 of W(0) in these scenes); the squares of their sum and the sum
// of their squares differ by less than 2e-5 there.
TEST_P(OwnWeight, IsTheResponseOfTheMeanToEachParticle) {
  const Scene& scene = GetParam();
  const Weighed all(scene, scene.random_positions(60, 81), weights(60));
  std::vector<double> expected(all.weight.size());
  for (std::size_t b = 0; b < all.weight.size(); ++b) {
    const std::vector<double> share = all.response(b);
    for (std::size_t a = 0; a < share.size(); ++a) expected[a] += std::pow((a == b ? 1 : 0) - share[a], 2);
  }
  const std::vector<double> factors = all.factors();
  for (std::size_t a = 0; a < factors.size(); ++a) EXPECT_NEAR(factors[a], expected[a], 3e-5) << a;
}

TEST_P(OwnWeight, IsTheSameForAnyThreads) {
  const Scene& scene = GetParam();
  const Weighed all(scene, scene.random_positions(200, 82), weights(200));
  const auto with_threads = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return all.factors();
  };
  const std::vector<double> one = with_threads(1);
  EXPECT_EQ(one, with_threads(2));
}

TEST_P(OwnWeight, OfSomeIsThatOfThemAmongAll) {
  const Scene& scene = GetParam();
  const Weighed all(scene, scene.random_positions(200, 83), weights(200));
  std::vector<std::uint8_t> wanted(200);
  for (std::size_t i = 0; i < 200; i += 3) wanted[i] = 1;
  const std::vector<double> some = deviation_factors(all.lattice, all.kernel, all.position, all.weight,
                                                     all.total.blocks(), 0, Outside::refuse, wanted);
  const std::vector<double> factors = all.factors();
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(some[i], wanted[i] != 0 ? factors[i] : 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, OwnWeight, testing::ValuesIn(scenes()),
                         [](const auto& each) { return each.param.name; });

// A particle alone is its own mean; two at one place share it as their weights. Rounding of W in single precision,
// 1e-6, is all that may be left.
TEST(OwnWeightCases, LoneAndPairedParticles) {
  const Scene scene{"open", {{0, 0, 0}, {40, 10, 10}, {false, false, false}}, 1, {0, 0, 0}, 3.2};
  const Weighed all(scene, {{{5.2, 25.7, 25.7}, {5.1, 5.3, 5.3}, {4.9, 5, 5}}}, {2, 1, 3});
  const std::vector<double> f = all.factors();
  EXPECT_LE(f[0], 1e-24);  // formed in double
  EXPECT_NEAR(f[1], 2 * 0.75 * 0.75, 2e-6);
  EXPECT_NEAR(f[2], 2 * 0.25 * 0.25, 2e-6);
}

TEST(OwnWeightCases, RefusesWhatSamplingRefuses) {
  const Scene scene{"open", {{0, 0, 0}, {9, 9, 9}, {false, false, false}}, 1, {0, 0, 0}, 0.9};
  const Weighed all(scene, {{{4.9}, {4.9}, {4.9}}}, {1});
  EXPECT_THROW(all.factors(), std::logic_error);
}

}  // namespace
}  // namespace grainvdb::own_weight_test
