// Contacts, bond angles and backbones of crystals, chains and dumps.
#include "measure/contact_graph.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "lattices.hpp"

namespace grainvdb::testing::contact_graph_test {
namespace {

constexpr double pi = std::numbers::pi;

void expect_degree(const Scene& s, std::size_t degree) {
  const ContactGraph graph = contacts_by_gap(s.box, s.position, s.radius, 0.01);
  ASSERT_EQ(graph.size(), s.size());
  for (std::size_t i = 0; i < graph.size(); ++i) EXPECT_EQ(graph.degree(i), degree);
}

TEST(ContactsByGap, AreTheNeighboursInCrystals) {
  expect_degree(simple_cubic(4), 6);
  expect_degree(face_centred(3), 12);
  expect_degree(body_centred(3), 8);
  expect_degree(simple_cubic(1), 6);  // its own images
}

TEST(ContactsByGap, AreThoseOfTheSurfaces) {
  Scene s;
  s.box = {{0, 0, 0}, {9, 9, 9}, {false, false, false}};
  s.add({1, 1, 1}, 1.0);
  s.add({2.55, 1, 1}, 0.5);    // 0.05 apart
  s.add({2.55, 1.9, 1}, 0.3);  // 0.1 from the second, 0.49 from the first
  const auto count = [&](double gap) { return contacts_by_gap(s.box, s.position, s.radius, gap).partner.size(); };
  EXPECT_EQ(count(0.04), 0U);
  EXPECT_EQ(count(0.06), 2U);
  EXPECT_EQ(count(0.11), 4U);
  EXPECT_EQ(count(0.5), 6U);
}

BondAngles angles_of(const Scene& s, std::size_t bins) {
  const ContactGraph graph = contacts_by_gap(s.box, s.position, s.radius, 0.01);
  BondAngles angles(bins);
  for (std::size_t i = 0; i < graph.size(); ++i) angles.add(graph, i);
  return angles;
}

TEST(BondAngles, AreRightAndStraightInTheSimpleCubicLattice) {
  const Scene s = simple_cubic(4);
  const BondAngles angles = angles_of(s, 45);  // of 4 degrees, so that 90 is the middle of one
  const auto n = static_cast<double>(s.size());
  for (std::size_t k = 0; k < 45; ++k) EXPECT_EQ(angles.count(k), k == 22 ? 12 * n : k == 44 ? 3 * n : 0) << k;
  EXPECT_NEAR(angles.density(22), 0.8 / (pi / 45), 1e-12);
}

TEST(BondAngles, AreThoseOfTheFaceCentredLattice) {
  const Scene s = face_centred(3);
  const BondAngles angles = angles_of(s, 45);
  const auto n = static_cast<double>(s.size());
  // 60, 90, 120 and 180 degrees: 24, 12, 24 and 6 pairs of the twelve neighbours. 60 and 120 are edges of bins.
  EXPECT_EQ(angles.count(14) + angles.count(15), 24 * n);
  EXPECT_EQ(angles.count(22), 12 * n);
  EXPECT_EQ(angles.count(29) + angles.count(30), 24 * n);
  EXPECT_EQ(angles.count(44), 6 * n);
  EXPECT_EQ(angles.total(), 66 * n);
}

TEST(BondAngles, HaveNoPreferenceForDirectionsAtRandom) {
  // A grain with 300 contacts in random directions. Two angles are independent even where they share a contact, so that
  // counts scatter as they would for 44850 angles of their own.
  Random random(5);
  ContactGraph graph;
  for (int c = 0; c < 300; ++c) graph.branch.push_back(random.normal3());
  graph.partner.assign(300, 0);
  graph.start = {0, 300};
  BondAngles angles(18);
  angles.add(graph, 0);
  double total = 0;
  for (std::size_t k = 0; k < 18; ++k) {
    EXPECT_NEAR(angles.relative(k), 1, 5 / std::sqrt(angles.count(k))) << k;
    total += angles.density(k) * pi / 18;
  }
  EXPECT_NEAR(total, 1, 1e-12);
}

TEST(ContactsOfDump, CountForBothAndForOneOfAGrainThatIsNotSelected) {
  Particles p;
  p.id = {2, 5, 9};
  Contacts c;
  c.id1 = {2, 2, 5, 7};
  c.id2 = {5, 7, 9, 8};  // 7 and 8 are not among the particles
  const ContactGraph graph = contacts_of_dump(p, c);
  EXPECT_EQ(graph.degree(0), 2U);
  EXPECT_EQ(graph.degree(1), 2U);
  EXPECT_EQ(graph.degree(2), 1U);
  EXPECT_EQ(graph.partner, (std::vector<std::uint32_t>{1, ContactGraph::outside, 0, 2, 1}));
}

ContactGraph chain_with_ring() {
  // 0-1-2 hang on the ring 3-4-5; 6 is alone.
  Particles p;
  p.id = {0, 1, 2, 3, 4, 5, 6};
  Contacts c;
  c.id1 = {0, 1, 2, 3, 4, 3};
  c.id2 = {1, 2, 3, 4, 5, 5};
  return contacts_of_dump(p, c);
}

TEST(Backbone, LosesWhatRestsOnWhatIsLost) {
  const ContactGraph graph = chain_with_ring();
  EXPECT_EQ(backbone(graph, 1), (std::vector<bool>{true, true, true, true, true, true, false}));
  EXPECT_EQ(backbone(graph, 2), (std::vector<bool>{false, false, false, true, true, true, false}));
  EXPECT_EQ(backbone(graph, 3), std::vector<bool>(7, false));
}

}  // namespace
}  // namespace grainvdb::testing::contact_graph_test
