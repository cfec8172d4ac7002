#include "spot/particle_store.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "spot/random_packing.hpp"
#include "support/random.hpp"

namespace grainvdb::spot::particle_store_test {
namespace {

double distance(const ParticleStore& store, std::int32_t i, std::int32_t j) {
  const Vec3 x = store.position(i), y = store.position(j);
  double r2 = 0;
  for (int a = 0; a < 3; ++a) r2 += std::pow(store.box().minimum_image(a, x[a] - y[a]), 2);
  return std::sqrt(r2);
}

constexpr std::array every_kind{ParticleStore::Neighbours::none, ParticleStore::Neighbours::listed,
                                ParticleStore::Neighbours::listed_on_request};

// Whoever overlaps a particle is in its list.
void expect_complete_list(const ParticleStore& store, std::int32_t i) {
  const NearView near = store.near();
  std::set<std::int32_t> listed;
  for (std::size_t k = 0; k < static_cast<std::size_t>(near.counts[i]); ++k)
    listed.insert(near.at(static_cast<std::size_t>(i), k));
  EXPECT_EQ(listed.size(), static_cast<std::size_t>(near.counts[i]));
  EXPECT_FALSE(listed.contains(i));
  for (const std::int32_t j : store.places())
    if (j != i && distance(store, i, j) < store.diameter()) {
      EXPECT_TRUE(listed.contains(j)) << i << ' ' << j;
    }
  for (const std::int32_t j : listed) EXPECT_TRUE(store.holds(j));
  for (std::size_t k = static_cast<std::size_t>(near.counts[i]); k % NearView::group != 0; ++k)
    EXPECT_EQ(near.at(static_cast<std::size_t>(i), k), i);
}

// Every pair that overlaps is in both lists, however the particles have moved.
void expect_complete_lists(const ParticleStore& store) {
  for (const std::int32_t i : store.places()) expect_complete_list(store, i);
}

TEST(ParticleStore, ListsStayCompleteWhileParticlesMoveAndGo) {
  const Box box{{0, 0, 0}, {8, 7, 9}, {true, false, false}};
  ParticleStore store(box, poisson_packing(box, 0.5, 1, 1), ParticleStore::Neighbours::listed);
  testing::Random random(2);
  for (int round = 0; round < 40; ++round) {
    std::vector<std::int32_t> some;
    std::vector<Site> steps;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(store.slots()); ++i) {
      if (!store.holds(i) || random.uniform() < 0.5) continue;
      some.push_back(i);
      Site step;
      for (std::size_t a = 0; a < 3; ++a)
        step.at[a] = static_cast<std::int32_t>(random.uniform(-0.1, 0.1) / store.unit()[a]);
      steps.push_back(step);
    }
    store.move_each(some, steps);
    store.take_out(store.places()[some.size() / 2]);
    if (round % 10 == 9) expect_complete_lists(store);
    if (round == 24) store.compact();
  }
}

// The zone is marked while the lists of those that a spot has moved are renewed.
TEST(ParticleStore, ListsStayCompleteWhileSpotsPass) {
  const Box box{{0, 0, 0}, {9, 8, 10}, {true, false, false}};
  ParticleStore store(box, poisson_packing(box, 0.55, 1, 6), ParticleStore::Neighbours::listed);
  testing::Random random(7);
  for (int round = 0; round < 400; ++round) {
    Site step;
    for (std::size_t a = 0; a < 3; ++a)
      step.at[a] = static_cast<std::int32_t>(random.uniform(-0.03, 0.03) / store.unit()[a]);
    const Site centre = store.site_at({random.uniform(0, 9), random.uniform(0, 8), random.uniform(0, 10)});
    store.move_and_mark(centre, {2, 3}, step);
    if (round % 40 == 39) expect_complete_lists(store);
    for (const std::int32_t i : store.zone()) EXPECT_EQ(store.site(i).mark, Site::in_zone);
    store.move_zone(std::vector<Site>(store.zone().size()));
    for (const std::int32_t i : store.places()) EXPECT_EQ(store.site(i).mark, 0);
  }
}

TEST(ParticleStore, ListsOnRequestAreThoseOfTheZone) {
  const Box box{{0, 0, 0}, {9, 8, 10}, {true, false, false}};
  ParticleStore store(box, poisson_packing(box, 0.55, 1, 6), ParticleStore::Neighbours::listed_on_request);
  testing::Random random(7);
  for (int round = 0; round < 200; ++round) {
    Site step;
    for (std::size_t a = 0; a < 3; ++a)
      step.at[a] = static_cast<std::int32_t>(random.uniform(-0.3, 0.3) / store.unit()[a]);
    const Site centre = store.site_at({random.uniform(0, 9), random.uniform(0, 8), random.uniform(0, 10)});
    store.move_and_mark(centre, {2, 3}, step);
    if (round % 20 == 19) {
      store.list_zone();
      EXPECT_GT(store.zone().size(), 20U);
      for (const std::int32_t i : store.zone()) expect_complete_list(store, i);
    }
    store.move_zone(std::vector<Site>(store.zone().size()));
    for (const std::int32_t i : store.places()) EXPECT_EQ(store.site(i).mark, 0);
  }
}

// Where the packing ends is told by where particles are, whatever keeps account of them, and to the height of a cell.
TEST(ParticleStore, TopOfThePackingDoesNotDependOnLists) {
  const Box box{{0, 0, 0}, {8, 8, 12}, {true, true, false}};
  Packing packing = poisson_packing({{0, 0, 0}, {8, 8, 6}, {true, true, false}}, 0.1, 1, 13);
  std::deque<ParticleStore> stores;  // which moves none
  for (const auto neighbours : every_kind) stores.emplace_back(box, packing, neighbours);
  stores.emplace_back(box, packing, ParticleStore::Neighbours::listed, Floor{}, 0.5);
  testing::Random random(14);
  std::size_t reached = 0;
  for (int round = 0; round < 4000; ++round) {
    const Vec3 centre{random.uniform(0, 8), random.uniform(0, 8), random.uniform(4, 9)};
    const double way = random.uniform(-0.12, 0.1);
    Site step;
    step.at[2] = static_cast<std::int32_t>(way / stores[0].unit()[2]);
    for (ParticleStore& store : stores) store.move_within(store.site_at(centre), 1.5, step);
    double highest = 0;
    for (const std::int32_t i : stores[0].places()) highest = std::max(highest, stores[0].position(i)[2]);
    for (const double above : {-2.5, -1.5, -0.5, 0.5, 1.5}) {
      const bool reaches = stores[0].reaches(highest + above);
      reached += reaches ? 1 : 0;
      for (ParticleStore& store : stores) EXPECT_EQ(store.reaches(highest + above), reaches) << round << ' ' << above;
      if (above < 0) {
        EXPECT_TRUE(reaches);
      }
    }
    EXPECT_FALSE(stores[0].reaches(highest + 2.01));  // cells are 2 high
  }
  EXPECT_GT(reached, 3 * 4000U + 500);
}

// Where particles are by their ids, kept beside the store in the plainest way.
using Places = std::map<std::int64_t, Site>;
Places places_of(const ParticleStore& store) {
  Places places;
  for (const std::int32_t i : store.places()) places[store.id(i)] = store.site(i);
  return places;
}

std::size_t count_within(const ParticleStore& store, const Site& centre, double radius) {
  std::size_t count = 0;
  for (const std::int32_t i : store.places()) {
    double r2 = 0;
    for (int a = 0; a < 3; ++a)
      r2 += std::pow(store.box().minimum_image(a, store.position(i)[a] - store.position_of(centre)[a]), 2);
    count += r2 < radius * radius ? 1U : 0U;
  }
  return count;
}

TEST(ParticleStore, FindsParticlesThatHaveLeftTheirFirstCell) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {true, true, false}};
  for (const auto neighbours : every_kind) {
    ParticleStore store(box, poisson_packing(box, 0.5, 1, 3), neighbours);
    testing::Random random(4);
    Site step;
    for (std::size_t a = 0; a < 3; ++a) step.at[a] = static_cast<std::int32_t>(0.11 / store.unit()[a]);
    const Site middle = store.site_at({4, 4, 4});
    for (int round = 0; round < 60; ++round) {
      const Places before = places_of(store);
      const std::size_t expected = count_within(store, middle, 4);
      EXPECT_EQ(store.move_within(middle, 4, step), expected);
      std::size_t moved = 0;
      for (const auto& [id, site] : places_of(store)) moved += site.at != before.at(id).at ? 1U : 0U;
      EXPECT_EQ(moved, expected);
      const Site centre = store.site_at({random.uniform(0, 8), random.uniform(0, 8), random.uniform(0, 8)});
      EXPECT_EQ(store.find(centre, 2).size(), count_within(store, centre, 2));
    }
  }
}

// Two hundred particles come into one cell, which has sixteen places at first.
TEST(ParticleStore, CellsHoldAnyNumberOfParticles) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {false, false, false}};
  const Packing packing = poisson_packing(box, 0.2, 1, 8);
  for (const auto neighbours : every_kind) {
    ParticleStore store(box, packing, neighbours);
    Site step;
    for (std::size_t a = 0; a < 3; ++a) step.at[a] = -static_cast<std::int32_t>(0.5 / store.unit()[a]);
    for (int k = 0; k < 17; ++k) store.move_within(store.site_at({4, 4, 4}), 8, step);
    EXPECT_EQ(store.size(), packing.id.size());
    EXPECT_EQ(store.find(store.site_at({0, 0, 0}), 0.01).size(), packing.id.size());
    std::set<std::int64_t> ids;
    for (const std::int32_t i : store.places()) ids.insert(store.id(i));
    EXPECT_EQ(ids.size(), packing.id.size());
    if (neighbours == ParticleStore::Neighbours::listed) {
      expect_complete_lists(store);
    }
  }
}

TEST(ParticleStore, KeepsCentresBetweenWallsAndIdsThroughCompaction) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {false, true, false}};
  const Packing packing = poisson_packing(box, 0.2, 1, 5);
  ParticleStore store(box, packing, ParticleStore::Neighbours::listed, {1, 3});
  Site step;
  for (std::size_t a = 0; a < 3; ++a) step.at[a] = -static_cast<std::int32_t>(0.5 / store.unit()[a]);
  for (int k = 0; k < 20; ++k) store.move_each(store.places(), std::vector<Site>(store.size(), step));
  EXPECT_EQ(store.size(), packing.id.size());
  for (const std::int32_t i : store.places()) {
    EXPECT_NEAR(store.position(i)[0], 0, 1e-7);
    EXPECT_NEAR(store.position(i)[2], -1, 1e-7);
    EXPECT_GE(store.position(i)[1], 0);
    EXPECT_LT(store.position(i)[1], 8);
  }
  const std::int32_t one = store.places()[3];
  const std::int64_t gone = store.id(one);
  store.take_out(one);
  store.compact();
  std::set<std::int64_t> ids;
  for (const std::int32_t i : store.places()) ids.insert(store.id(i));
  EXPECT_EQ(ids.size(), packing.id.size() - 1);
  EXPECT_FALSE(ids.contains(gone));
}

TEST(ParticleStore, ParticlesLeaveBelowTheExit) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {true, true, false}};
  const Packing packing = poisson_packing(box, 0.5, 1, 9);
  for (const auto neighbours : every_kind) {
    ParticleStore store(box, packing, neighbours, {1.8, 0.5});
    const Places before = places_of(store);
    Site step;
    step.at[2] = -static_cast<std::int32_t>(1.5 / store.unit()[2]);
    const Site centre = store.site_at({4, 4, 1});
    const double exit = store.position_of(store.site_at({4, 4, -0.5}))[2];
    std::set<std::int64_t> expected;
    for (const auto& [id, site] : before) {
      Vec3 x = store.position_of(site);
      double r2 = 0;
      for (int a = 0; a < 3; ++a) r2 += std::pow(box.minimum_image(a, x[a] - store.position_of(centre)[a]), 2);
      if (r2 < 9 && x[2] - 1.5 < exit) expected.insert(id);
    }
    EXPECT_GT(expected.size(), 5U);
    store.move_within(centre, 3, step);
    const std::vector<std::int64_t> left = store.take_left();
    EXPECT_EQ(std::set<std::int64_t>(left.begin(), left.end()), expected);
    EXPECT_EQ(store.size() + left.size(), packing.id.size());
    EXPECT_TRUE(store.take_left().empty());
  }
}

TEST(RandomPacking, HasTheFractionAskedForAndNoOverlaps) {
  const Box box{{0, 0, 0}, {8, 8, 8}, {true, true, false}};
  const Packing packing = random_packing(box, 0.58, 1, 1);
  EXPECT_EQ(packing.id.size(), 567U);  // 0.58 · 512 / (π/6), rounded
  for (std::size_t i = 0; i < packing.id.size(); ++i) {
    EXPECT_GT(packing.position[i][2], 0.5 - 1e-3);
    for (std::size_t j = 0; j < i; ++j) {
      double r2 = 0;
      for (int a = 0; a < 3; ++a)
        r2 += std::pow(box.minimum_image(a, packing.position[i][a] - packing.position[j][a]), 2);
      EXPECT_GT(r2, std::pow(1 - 1e-3, 2));
    }
  }
}

}  // namespace
}  // namespace grainvdb::spot::particle_store_test
