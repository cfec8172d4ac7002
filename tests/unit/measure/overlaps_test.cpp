// The overlap badness of pairs, crystals and grains at random places.
#include "measure/overlaps.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::overlaps_test {
namespace {

TEST(Overlaps, OfOnePair) {
  Scene s;
  s.box = {{0, 0, 0}, {9, 9, 9}, {true, false, false}};
  s.add({0.1, 1, 1}, 0.5);
  s.add({8.2, 1, 1}, 0.7);  // 0.9 apart across the boundary, overlap 0.3 of 1.2
  s.add({5, 5, 5}, 0.5);
  const Overlaps o = overlaps(s.box, s.position, s.radius, {});
  EXPECT_EQ(o.grains, 3U);
  EXPECT_NEAR(o.badness, 2 * 0.0625 / 3, 1e-14);
  EXPECT_NEAR(o.largest, 0.25, 1e-14);
  EXPECT_NEAR(o.largest_length, 0.3, 1e-14);
  EXPECT_DOUBLE_EQ(o.overlapping, 2.0 / 3);
  EXPECT_NEAR(o.error, 2 * 0.0625 / 3, 1e-14);  // one event
}

TEST(Overlaps, AreNoneInCrystals) {
  Scene s = face_centred(3);
  for (double& r : s.radius) r = 0.5 * (1 - 1e-12);
  EXPECT_EQ(overlaps(s.box, s.position, s.radius, {}).badness, 0);
  for (double& r : s.radius) r = 0.5 / 0.9;  // 12 neighbours, each overlapping by a tenth
  EXPECT_NEAR(overlaps(s.box, s.position, s.radius, {}).badness, 0.12, 1e-12);
}

TEST(Overlaps, OfGrainsAtRandomPlacesComeToFourFifthsOfPhi) {
  const Box box{{0, 0, 0}, {10, 11, 12}, {true, true, true}};
  double chi2 = 0;
  constexpr int runs = 20;
  for (int run = 0; run < runs; ++run) {
    const Scene s = poisson(box, 1500, 100 + static_cast<std::uint64_t>(run));
    // A grain meets N - 1 others.
    const double phi = (static_cast<double>(s.size()) - 1) * std::numbers::pi / 6 / (10 * 11 * 12);
    const Overlaps o = overlaps(box, s.position, s.radius, {});
    chi2 += std::pow((o.badness - 0.8 * phi) / o.error, 2);
    EXPECT_LT(o.error, 0.05 * o.badness);
  }
  // Squares of unit normals: the mean of 20 of them is 1 ± 0.32.
  EXPECT_NEAR(chi2 / runs, 1, 3 * std::sqrt(2.0 / runs));
}

TEST(Overlaps, AreUndefinedWithoutGrains) {
  EXPECT_TRUE(std::isnan(overlaps({{0, 0, 0}, {1, 1, 1}, {}}, {}, {}, {}).badness));
}

}  // namespace
}  // namespace grainvdb::testing::overlaps_test
