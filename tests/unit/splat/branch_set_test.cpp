#include "splat/branch_set.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "unit/splat/branch_scene.hpp"

namespace grainvdb::branch_set_test {
namespace {

const Box box{{0, 0, 0}, {6, 6, 6}, {true, false, false}};
constexpr double cutoff = 1.5;

Lattice lattice() {
  Lattice l(0.25, {0, 0, 0});
  l.set_periods(box);
  return l;
}

/// Both halves of one contact, with values as their lengths: half of it each when the contact point is in the middle.
struct Contact {
  HalfBranches branches;
  std::vector<double> q;
};
Contact contact(double share, const Vec3& off_line = {0, 0, 0}) {
  const Vec3 x{3, 3, 3}, l{0.3, -0.36, 0.12};
  Contact c;
  for (std::size_t a = 0; a < 3; ++a) {
    c.branches.start[a] = {x[a], x[a] - l[a]};
    c.branches.arm[a] = {share * l[a] - off_line[a], (share - 1) * l[a] - off_line[a]};
    c.branches.force[a] = {0, 0};
  }
  c.q = {2 * share, 3 * share, 2 * (1 - share), 3 * (1 - share)};
  return c;
}

std::size_t pieces(const Contact& c, LineIntegral method = LineIntegral::adaptive()) {
  const LucyKernel kernel(cutoff);
  const Lattice l = lattice();
  return BranchSet(l, kernel, c.branches, {c.q, 2}, method).buckets().point.size();
}

TEST(BranchSet, JoinsTheHalvesOfAContactOnTheLineOfCentres) {
  for (const double share : {0.5, 0.3, 0.9}) EXPECT_EQ(pieces(contact(share)), 1u);
  EXPECT_EQ(pieces(contact(0.5), LineIntegral::gauss(3)), 2u);
  EXPECT_EQ(pieces(contact(0.5), LineIntegral::exact()), 2u);
  // Halves of 0.16 cutoffs each; of 0.29 and 0.03, of which one is divided.
  EXPECT_EQ(pieces(contact(0.5), LineIntegral::midpoint_curvature()), 2u);
  EXPECT_EQ(pieces(contact(0.9), LineIntegral::midpoint_curvature()), 3u);
}

TEST(BranchSet, TheWholeHasTheArmAndTheValuesOfBoth) {
  const Contact c = contact(0.3);
  const LucyKernel kernel(cutoff);
  const Lattice l = lattice();
  const BranchSet set(l, kernel, c.branches, {c.q, 2}, LineIntegral::adaptive());
  EXPECT_NEAR(set.arm(0)[0], 0.3, 1e-15);
  EXPECT_NEAR(set.arm(0)[1], -0.36, 1e-15);
  EXPECT_NEAR(set.value(0, 0), 2, 1e-15);
  EXPECT_NEAR(set.value(0, 1), 3, 1e-15);
  EXPECT_NEAR(set.buckets().index[0][0], l.to_index(0, 2.85), 1e-12);
  EXPECT_NEAR(set.half_arm(), norm({0.15, 0.18, 0.06}), 1e-15);
}

TEST(BranchSet, JoinsAcrossAPeriodicBoundary) {
  Contact c = contact(0.5);
  c.branches.start[0][1] += 6;
  EXPECT_EQ(pieces(c), 1u);
  c.branches.start[1][1] += 6;  // y is not periodic
  EXPECT_EQ(pieces(c), 2u);
}

TEST(BranchSet, LeavesApartWhatIsNotOneStraightBranch) {
  EXPECT_EQ(pieces(contact(0.5, {1e-7 * cutoff, 0, 0})), 1u);
  EXPECT_EQ(pieces(contact(0.5, {1e-5 * cutoff, 0, 0})), 2u);  // the point is off the line
  EXPECT_EQ(pieces(contact(1.2)), 2u);                         // or beyond one of the centres
  Contact gap = contact(0.5);
  gap.branches.start[2][1] += 1e-5;
  EXPECT_EQ(pieces(gap), 2u);
}

TEST(BranchSet, LeavesApartWhatIsNotSpreadEvenly) {
  for (std::size_t k = 0; k < 4; ++k) {
    Contact c = contact(0.5);
    c.q[k] *= 1 + 1e-7;
    EXPECT_EQ(pieces(c), 1u);
    c.q[k] *= 1 + 1e-5;
    EXPECT_EQ(pieces(c), 2u) << k;
    c.q[k] *= -1;
    EXPECT_EQ(pieces(c), 2u) << k;
  }
}

// The sums of species, which have the halves apart, add up to that of all.
TEST(BranchSet, LeavesApartTheHalvesOfTwoSpecies) {
  Contact c = contact(0.5);
  c.branches.species = {1, 1};
  EXPECT_EQ(pieces(c), 1u);
  c.branches.species = {1, -1};
  EXPECT_EQ(pieces(c), 2u);
}

TEST(BranchSet, DividesBranchesThatNoRuleCanIntegrate) {
  Contact c = contact(0.5);
  for (auto& column : c.branches.arm) column[1] = 0;
  c.branches.start[0] = {4, 3};  // so far from the bounds that there are no images
  for (std::size_t a = 0; a < 3; ++a) c.branches.arm[a][0] = a == 0 ? 1.9 * cutoff * longest_branch(8) : 0;
  const LucyKernel kernel(cutoff);
  const Lattice l = lattice();
  const BranchSet set(l, kernel, c.branches, {c.q, 2}, LineIntegral::adaptive());
  const auto& points = set.buckets().point;
  double sum = 0;
  std::vector<double> middles;
  for (std::size_t e = 0; e < points.size(); ++e) {
    if (norm(set.arm(points[e])) == 0) continue;
    EXPECT_NEAR(set.arm(points[e])[0], 0.95 * cutoff * longest_branch(8), 1e-12);
    sum += set.value(points[e], 0);
    middles.push_back(set.buckets().index[0][e]);
  }
  EXPECT_NEAR(sum, c.q[0], 1e-15);
  ASSERT_EQ(middles.size(), 2u);
  EXPECT_NEAR(std::abs(middles[1] - middles[0]), 0.95 * cutoff * longest_branch(8) / 0.25, 1e-9);
}

TEST(BranchSet, RefusesAbsurdArms) {
  Contact c = contact(0.5);
  c.branches.arm[0][0] = 1e7;
  EXPECT_THROW(pieces(c), std::invalid_argument);
}

}  // namespace
}  // namespace grainvdb::branch_set_test
