// g(r) of crystals, of grains at random places, and of random places in slabs, boxes and parts of them.
#include "measure/pair_correlation.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::pair_correlation_test {
namespace {

CountedRegion region(std::vector<double> lo, std::vector<double> hi) {
  return CountedRegion({{"lo", std::move(lo)}, {"hi", std::move(hi)}});
}

/// Shells of a lattice: distance² over that of the first, and how many neighbours lie there.
using Shells = std::vector<std::pair<double, double>>;

void expect_shells(const Scene& s, const Shells& shells) {
  const double reach = std::sqrt(shells.back().first) + 0.01;
  PairCounts counts(reach, 1000);
  counts.add(s.box, s.position, {});
  double before = 0;
  std::size_t shell = 0;
  for (std::size_t k = 0; k < counts.bins(); ++k) {
    const double more = counts.neighbours(k) - before;
    before = counts.neighbours(k);
    const bool has_shell = shell < shells.size() && std::sqrt(shells[shell].first) <= counts.edge(k + 1);
    if (!has_shell) {
      EXPECT_NEAR(more, 0, 1e-9) << "at " << counts.edge(k);
      continue;
    }
    EXPECT_NEAR(more, shells[shell].second, 1e-9) << "shell " << shell;
    ++shell;
  }
  EXPECT_EQ(shell, shells.size());
  EXPECT_NEAR(counts.closest(), 1, 1e-12);
}

TEST(PairCorrelation, HasTheShellsOfCrystals) {
  expect_shells(simple_cubic(7), {{1, 6}, {2, 12}, {3, 8}, {4, 6}, {5, 24}, {6, 24}, {8, 12}, {9, 30}});
  expect_shells(face_centred(5), {{1, 12}, {2, 6}, {3, 24}, {4, 12}, {5, 24}, {6, 8}, {7, 48}, {8, 6}});
  expect_shells(body_centred(6), {{1, 8}, {4. / 3, 6}, {8. / 3, 12}, {11. / 3, 24}, {4, 8}, {16. / 3, 6}});
}

TEST(PairCorrelation, CountsEachPairOnceInBoxesNarrowerThanItsReach) {
  // 4 × 4 × 4: all 63 others are found by their nearest images, within √12.
  const Scene s = simple_cubic(4);
  PairCounts counts(3.6, 100);
  counts.add(s.box, s.position, {});
  EXPECT_DOUBLE_EQ(counts.neighbours(99), 63);
}

const auto boxed = [](bool x, bool y, bool z) { return Box{{0, 0, 0}, {9, 7, 8}, {x, y, z}}; };

TEST(PairCorrelation, ScattersAboutOneAsStatedForRandomPlacesInAPeriodicBox) {
  // To 6, far beyond half the box, where only its corners are left.
  PairCounts counts(6, 24);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Scene s = poisson(boxed(true, true, true), 600, 40 + seed);
    counts.add(s.box, s.position, {});
  }
  double chi2 = 0, bins = 0;
  for (std::size_t k = 0; k < counts.bins(); ++k) {
    if (!(counts.error(k) < 0.3)) continue;  // few pairs are not normally distributed
    ++bins;
    chi2 += std::pow((counts.g(k) - 1) / counts.error(k), 2);
  }
  ASSERT_GT(bins, 20);
  // The sum of the squares of n unit normals is n ± √(2n).
  EXPECT_NEAR(chi2, bins, 4 * std::sqrt(2 * bins));
}

/// The mean of g over packings is 1 within 4.5 of its standard errors, which their scatter gives: near open faces the
/// number of pairs also depends on how many grains lie there, so that it scatters more than counting.
void expect_one_on_average(const Box& box, std::size_t n, const CountedRegion& counted, double reach) {
  constexpr std::size_t runs = 24, bins = 12;
  std::vector<double> sum(bins), squares(bins);
  for (std::size_t run = 0; run < runs; ++run) {
    PairCounts counts(reach, bins);
    counts.add(box, poisson(box, n, 400 + run).position, counted);
    for (std::size_t k = 0; k < bins; ++k) {
      sum[k] += counts.g(k) - 1;
      squares[k] += std::pow(counts.g(k) - 1, 2);
    }
  }
  for (std::size_t k = 0; k < bins; ++k) {
    const double mean = sum[k] / runs, error = std::sqrt((squares[k] / runs - mean * mean) / (runs - 1));
    EXPECT_LT(std::abs(mean), 4.5 * error) << "bin " << k;
    EXPECT_LT(error, k == 0 ? 0.2 : 0.04) << "bin " << k;
  }
}

TEST(PairCorrelation, IsOneForRandomPlacesBetweenFaces) {
  expect_one_on_average(boxed(true, false, true), 600, {}, 6);
  expect_one_on_average(boxed(false, false, false), 600, {}, 7);
}

TEST(PairCorrelation, IsOneInAPartOfTheMaterial) {
  expect_one_on_average({{0, 0, 0}, {12, 8, 12}, {false, true, false}}, 1200, region({1, -1e9, 2}, {5, 1e9, 9}), 5);
}

TEST(PairCorrelation, IsTheSameHoweverFramesAreSplitAmongThem) {
  // Counts add: two frames of a crystal are as one.
  const Scene s = face_centred(4);
  PairCounts once(2, 50), twice(2, 50);
  once.add(s.box, s.position, {});
  for (int n = 0; n < 2; ++n) twice.add(s.box, s.position, {});
  for (std::size_t k = 0; k < 50; ++k) EXPECT_NEAR(once.g(k), twice.g(k), 1e-12 * once.g(k));
}

TEST(PairCorrelation, IsUndefinedWithoutGrains) {
  PairCounts counts(2, 10);
  counts.add({{0, 0, 0}, {1, 1, 1}, {true, true, true}}, {}, {});
  EXPECT_TRUE(std::isnan(counts.g(3)));
  EXPECT_EQ(counts.grains(), 0);
}

}  // namespace
}  // namespace grainvdb::testing::pair_correlation_test
